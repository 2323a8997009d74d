//! Errors and warnings as they are shown: with source excerpts on a terminal, one line each elsewhere.

use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Renderer, Snippet};
use fisura::simulation::breakdown::Breakdown;
use fisura_reports::ReportError;
use fisura_verification::output::OutputError;
use fisura_verification::output::foreign::text;
use fisura_verification::scene::{SceneDiagnostic, SceneFile, SceneFileError, Severity};

use crate::console;
use crate::exit::Exit;

/// Why a command could not do what was asked.
#[derive(Debug)]
pub enum Failure {
    /// A file of a scene or a case is not valid.
    SceneFile(SceneFileError),
    /// Any other failure, with a message of its own.
    Other {
        /// Exit status with which the command ends.
        exit: Exit,
        /// What is wrong, in words.
        message: String,
        /// What would be right, if it is not plain from the message.
        help: Option<String>,
    },
}

impl Failure {
    /// A failure without help.
    pub fn new(exit: Exit, message: impl Into<String>) -> Self {
        Self::Other { exit, message: message.into(), help: None }
    }

    /// Bad arguments or bad input.
    pub fn input(message: impl Into<String>) -> Self {
        Self::new(Exit::BadInput, message)
    }

    /// A run of the scene in `file` that broke down, or could not start because of what the file says.
    pub fn of_run(breakdown: &Breakdown, file: &SceneFile) -> Self {
        breakdown.scene.as_ref().map_or_else(|| breakdown.into(), |error| file.error(error).into())
    }

    /// The same with what would be right.
    pub fn help(self, text: impl Into<String>) -> Self {
        match self {
            Self::Other { exit, message, .. } => Self::Other { exit, message, help: Some(text.into()) },
            scene_file => scene_file,
        }
    }

    /// Writes the failure to standard error and gives its exit status.
    pub fn show(&self) -> Exit {
        let graphical = console::graphical();
        let shown = self.render(graphical);
        if graphical {
            console::picture(&shown)
        } else {
            console::error_text(&shown)
        }
        match self {
            Self::SceneFile(_) => Exit::BadInput,
            Self::Other { exit, .. } => *exit,
        }
    }

    /// The exit status of a command with a verdict of its own: what the checks say is more than that
    /// something could not be written or drawn, which is then shown.
    ///
    /// # Errors
    /// The failure, if the checks hold.
    pub fn beside(verdict: Exit, rest: Result<(), Self>) -> Result<Exit, Self> {
        match (verdict, rest) {
            (verdict, Ok(())) => Ok(verdict),
            (Exit::Done, Err(failure)) => Err(failure),
            (verdict, Err(failure)) => {
                failure.show();
                Ok(verdict)
            }
        }
    }

    fn render(&self, graphical: bool) -> String {
        match self {
            Self::SceneFile(error) => error.diagnostics.iter().map(|d| render(d, graphical)).collect(),
            Self::Other { message, help, .. } if graphical => {
                let help = help.as_ref().map(|help| text(help).into_owned());
                picture(Level::ERROR, &text(message), help.as_ref(), None)
            }
            Self::Other { message, help, .. } => {
                let help = help.as_ref().map(|h| format!("  help: {h}\n")).unwrap_or_default();
                format!("error: {message}\n{help}")
            }
        }
    }
}

impl From<SceneFileError> for Failure {
    fn from(error: SceneFileError) -> Self {
        Self::SceneFile(error)
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Self::input(error.message).help(error.remedy)
    }
}

impl From<&Breakdown> for Failure {
    fn from(breakdown: &Breakdown) -> Self {
        match &breakdown.scene {
            Some(error) => Self::input(error.to_string()).help(error.remedy.clone()),
            None => Self::new(Exit::BrokeDown, breakdown.to_string()),
        }
    }
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        match error {
            ReportError::Output(error) => error.into(),
            other => Self::input(other.to_string()),
        }
    }
}

/// One finding in a file: `error: file:line:column: key: message; remedy`, or with the excerpt around it.
pub fn render(diagnostic: &SceneDiagnostic, graphical: bool) -> String {
    if graphical {
        return excerpt(&diagnostic.for_terminal());
    }
    let word = if diagnostic.severity == Severity::Error { "error" } else { "warning" };
    format!("{word}: {diagnostic}\n")
}

/// A finding with the excerpt around its place, which is not told once more in the title.
fn excerpt(diagnostic: &SceneDiagnostic) -> String {
    let SceneDiagnostic { file, line, column, key, message, remedy, span, severity, .. } = diagnostic;
    let level = if *severity == Severity::Error { Level::ERROR } else { Level::WARNING };
    let key = if key.is_empty() { String::new() } else { format!("{key}: ") };
    let place = AnnotationKind::Primary.span(span.clone());
    let snippet = Snippet::source(diagnostic.text()).path(file.as_str()).annotation(place);
    let title = format!("{file}:{line}:{column}: {key}{message}");
    picture(level, &title, Some(remedy).filter(|remedy| !remedy.is_empty()), Some(snippet))
}

/// With colours, for a terminal.
fn picture(level: Level, title: &str, help: Option<&String>, snippet: Option<Snippet<Annotation>>) -> String {
    let mut group = Group::with_title(level.primary_title(title));
    group = snippet.into_iter().fold(group, Group::element);
    group = help.into_iter().fold(group, |group, help| group.element(Level::HELP.message(help.as_str())));
    Renderer::styled().render(&[group]) + "\n\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn broken() -> Failure {
        SceneFile::parse("scene.toml", "[mesh]\ndegree = 7\n", &[]).unwrap_err().into()
    }

    #[test]
    fn a_finding_names_place_key_and_remedy_in_either_form() {
        for graphical in [false, true] {
            let text = broken().render(graphical);
            for part in ["scene.toml:2:", "mesh.degree", "between 1 and 4"] {
                assert!(text.contains(part), "{part:?} is missing from\n{text}");
            }
        }
    }

    #[test]
    fn what_a_file_or_a_message_holds_does_not_steer_the_terminal() {
        let scene = "# \u{9b}2J \u{202e}\r\n[mesh]\ndegree = 7 # \u{1b}]0;owned\u{7}\n\"a\u{7f}b\" = 1\n";
        let failures = [
            SceneFile::parse("sc\u{1b}[2Jene.toml", scene, &[]).unwrap_err().into(),
            Failure::input("no \u{9b}2J").help("yes \u{1b}[1A"),
        ];
        for failure in failures {
            let pictured = failure.render(true);
            for sequence in ["\u{1b}]0", "\u{1b}[2J", "\u{1b}[1A", "\u{9b}", "\u{7f}", "\u{7}", "\u{202e}"] {
                assert!(!pictured.contains(sequence), "{sequence:?} in {pictured:?}");
            }
        }
    }

    #[test]
    fn a_verdict_is_more_than_a_file_that_cannot_be_written() {
        let full = || Err(Failure::input("the disk is full"));
        for verdict in [Exit::CheckFailed, Exit::BrokeDown] {
            assert_eq!(Failure::beside(verdict, full()).unwrap(), verdict);
        }
        assert!(Failure::beside(Exit::Done, full()).is_err());
        assert_eq!(Failure::beside(Exit::Done, Ok(())).unwrap(), Exit::Done);
    }

    #[test]
    fn off_a_terminal_a_finding_is_one_line() {
        let text = broken().render(false);
        assert!(text.lines().all(|line| line.starts_with("error: scene.toml:")), "{text}");
        let text = Failure::input("no").help("yes").render(false);
        assert_eq!(text, "error: no\n  help: yes\n");
    }
}
