//! A scene from the command line.

use fisura_verification::scene::SceneFile;

use crate::cli::{Common, SceneArgs};
use crate::failure::{self, Failure};
use crate::{console, folders};

/// Reads and checks a scene, shows its warnings, and gives it a title if it has none.
///
/// # Errors
/// Everything wrong with the file or the overrides.
pub fn load(args: &SceneArgs, common: &Common) -> Result<SceneFile, Failure> {
    let mut file = SceneFile::load(&folders::find(&args.scene)?, &args.set)?;
    if !common.quiet {
        let graphical = console::graphical();
        let show = if graphical { console::picture } else { console::error_text };
        file.warnings.iter().for_each(|w| show(&failure::render(w, graphical)));
    }
    if file.scene.title.is_empty() {
        file.scene.title = args.scene.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    }
    Ok(file)
}
