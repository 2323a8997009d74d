//! What is written, what stays, and who may write.

use super::temporary::{PART, TEMPORARY};
use super::*;

fn open(path: &Path) -> OutputFolder {
    OutputFolder::open(path, "verify").unwrap()
}

/// The folder as a process leaves it that is killed: the manifest as it is, no lock.
fn killed(folder: &OutputFolder) -> tempfile::TempDir {
    let copy = tempfile::tempdir().unwrap();
    let names = folder.files().into_iter().chain([MANIFEST.to_string()]);
    for name in names.filter(|name| folder.path().join(name).exists()) {
        fs::create_dir_all(copy.path().join(&name).parent().unwrap()).unwrap();
        fs::copy(folder.path().join(&name), copy.path().join(&name)).unwrap();
    }
    copy
}

fn names(path: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(path).unwrap().map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.retain(|name| name != lock::LOCK && name != MANIFEST);
    names.sort();
    names
}

#[test]
fn only_what_was_written_here_is_removed() {
    let root = tempfile::tempdir().unwrap();
    let folder = open(root.path());
    for name in ["results.json", "series/a.csv", "series/timing/b.csv", "partial/c.json"] {
        folder.write(name, name).unwrap();
    }
    folder.finish().unwrap();
    drop(folder);
    for name in ["series/mine.csv", "notes.txt", "checkpoint.bin", "report.html.part"] {
        fs::write(root.path().join(name), "mine").unwrap();
    }
    let folder = open(root.path());
    folder.begin(|name| name.starts_with("partial/")).unwrap();
    assert_eq!(names(root.path()), ["checkpoint.bin", "notes.txt", "partial", "report.html.part", "series"]);
    assert_eq!(names(&root.path().join("series")), ["mine.csv"]);
    for name in ["notes.txt", "series/mine.csv", "checkpoint.bin"] {
        let error = folder.write(name, "ours").unwrap_err();
        assert!(error.message.contains(name) && error.remedy.contains("--out"), "{error:?}");
        assert!(folder.remove(name).is_err() && folder.check(name).is_err());
        assert_eq!(fs::read_to_string(root.path().join(name)).unwrap(), "mine");
    }
}

#[test]
fn a_changed_file_is_refused_before_anything_is_removed() {
    let root = tempfile::tempdir().unwrap();
    let folder = open(root.path());
    for name in ["a.csv", "b.csv"] {
        folder.write(name, "1").unwrap();
    }
    fs::write(root.path().join("b.csv"), "12").unwrap();
    let error = folder.begin(|_| false).unwrap_err();
    assert!(error.message.contains("changed after they were written: b.csv"), "{error:?}");
    assert!(folder.write("b.csv", "3").is_err() && folder.read("b.csv").is_none());
    assert_eq!(
        (names(root.path()), folder.read("a.csv").unwrap()),
        (vec!["a.csv".into(), "b.csv".into()], b"1".to_vec())
    );
}

#[test]
fn folders_of_others_are_refused_and_stay_as_they_are() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("results.json"), "{}").unwrap();
    let error = OutputFolder::open(root.path(), "verify").unwrap_err();
    assert!(error.message.contains("is not empty and has no fisura.sha256"), "{error:?}");
    assert!(OutputFolder::reopen(root.path()).is_err());
    assert_eq!(fs::read_dir(root.path()).unwrap().count(), 1, "no lock is left");

    let root = tempfile::tempdir().unwrap();
    open(root.path()).write("results.json", "{}").unwrap();
    let error = OutputFolder::open(root.path(), "run").unwrap_err();
    assert!(error.message.contains("contains the output of `verify`"), "{error:?}");
    OutputFolder::reopen(root.path()).unwrap().write("report.html", "").unwrap();
    assert_eq!(names(root.path()), ["report.html", "results.json"]);
    open(root.path()).begin(|_| false).unwrap();
    assert!(names(root.path()).is_empty(), "both commands share the manifest");
}

#[test]
fn one_process_writes_at_a_time_and_is_named() {
    let root = tempfile::tempdir().unwrap();
    let folder = open(root.path());
    let error = OutputFolder::open(root.path(), "verify").unwrap_err();
    assert!(error.message.contains(&format!("in use by process {}: ", std::process::id())), "{error:?}");
    drop(folder);
    open(root.path());
}

#[test]
fn a_killed_process_leaves_a_folder_that_the_next_one_knows() {
    let root = tempfile::tempdir().unwrap();
    let folder = open(root.path());
    folder.begin(|_| false).unwrap();
    folder.write("checkpoint.bin", "1").unwrap();
    folder.write("checkpoint.bin", "2").unwrap();
    let copy = killed(&folder);
    let text = fs::read_to_string(copy.path().join(MANIFEST)).unwrap();
    assert!(text.contains("# unfinished") && !fs::read_to_string(root.path().join(MANIFEST)).unwrap().is_empty());
    let part = format!("{TEMPORARY}AbCdEf{PART}");
    fs::write(copy.path().join(&part), "half").unwrap();
    let hash = manifest::hash(b"whole");
    fs::write(copy.path().join(MANIFEST), format!("{text}{hash}  {part}\n{hash}  next.csv\n{hash}  half a li"))
        .unwrap();
    fs::write(copy.path().join(".fisura-mine.part"), "mine").unwrap();
    let next = open(copy.path());
    assert_eq!(names(copy.path()), [".fisura-mine.part", "checkpoint.bin"], "the listed temporary file is gone");
    assert_eq!(next.files(), ["checkpoint.bin", "next.csv"]);
    next.write("checkpoint.bin", "3").unwrap();
    next.finish().unwrap();
    assert!(!fs::read_to_string(copy.path().join(MANIFEST)).unwrap().contains("# unfinished"));
}

/// What a killed process left of a file that grew is replaced, with all it holds; a file of the user is not.
#[test]
fn a_file_that_grows_is_read_on_the_way_and_replaced_by_the_next_process() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let out = open(path);
    out.begin(|_| false).unwrap();
    let mut file = out.grow("rows.csv").unwrap();
    file.add(b"a\n1\n").unwrap();
    file.add(b"2\n").unwrap();
    assert_eq!(fs::read_to_string(path.join("rows.csv")).unwrap(), "a\n1\n2\n");
    let left = killed(&out);
    let next = open(left.path());
    assert_eq!(next.files(), ["rows.csv"]);
    next.begin(|_| false).unwrap();
    assert!(!left.path().join("rows.csv").exists());
    fs::write(left.path().join("rows.csv"), "mine").unwrap();
    assert!(next.grow("rows.csv").is_err());
    assert_eq!(fs::read_to_string(left.path().join("rows.csv")).unwrap(), "mine");

    out.write("rows.csv", "a\n1\n2\n3\n").unwrap();
    out.finish().unwrap();
    drop(out);
    fs::write(path.join("rows.csv"), "mine").unwrap();
    assert!(open(path).begin(|_| false).is_err(), "a file that is finished has its hash");
}

#[test]
fn names_that_lead_out_of_the_folder_are_refused() {
    let root = tempfile::tempdir().unwrap();
    let folder = open(&root.path().join("out"));
    for name in ["../a", "/a", "series/../../a", "", "."] {
        assert!(folder.write(name, "x").is_err(), "{name:?}");
    }
    assert_eq!(names(root.path()), ["out"]);
    assert!(folder.write(MANIFEST, "x").is_err() && folder.write(lock::LOCK, "x").is_err());
}

#[cfg(unix)]
#[test]
fn nothing_is_written_or_removed_through_a_link() {
    use std::os::unix::fs::symlink;
    let root = tempfile::tempdir().unwrap();
    let mine = root.path().join("mine");
    fs::create_dir(&mine).unwrap();
    fs::write(mine.join("a.svg"), "drawn").unwrap();
    let folder = open(&root.path().join("out"));
    folder.write("figures/a.svg", "drawn").unwrap();
    fs::remove_dir_all(folder.path().join("figures")).unwrap();
    symlink(&mine, folder.path().join("figures")).unwrap();
    symlink(mine.join("a.svg"), folder.path().join("report.html")).unwrap();
    symlink(mine.join("new"), folder.path().join("dangling")).unwrap();
    for name in ["figures/a.svg", "figures/b.svg", "report.html", "dangling"] {
        assert!(folder.write(name, "x").is_err(), "{name}");
    }
    assert!(folder.begin(|_| false).is_err(), "what lies behind the link is not removed");
    assert_eq!((names(&mine), fs::read_to_string(mine.join("a.svg")).unwrap()), (vec!["a.svg".into()], "drawn".into()));

    let other = root.path().join("other");
    fs::create_dir(&other).unwrap();
    symlink(mine.join("a.svg"), other.join(lock::LOCK)).unwrap();
    assert!(OutputFolder::open(&other, "verify").is_err());
    assert_eq!(fs::read_to_string(mine.join("a.svg")).unwrap(), "drawn");
}

#[cfg(unix)]
#[test]
fn files_have_the_permissions_of_any_new_file() {
    use std::os::unix::fs::PermissionsExt;
    let root = tempfile::tempdir().unwrap();
    let folder = open(root.path());
    folder.write("a", "x").unwrap();
    fs::write(root.path().join("b"), "x").unwrap();
    let [a, b] = ["a", "b"].map(|name| fs::metadata(root.path().join(name)).unwrap().permissions().mode());
    assert_eq!(a, b);
}

#[test]
fn no_temporary_file_is_there_that_is_not_listed() {
    let root = tempfile::tempdir().unwrap();
    let folder = open(root.path());
    folder.begin(|_| false).unwrap();
    let is_over = std::sync::atomic::AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            (0..300).for_each(|number| folder.write(&format!("{}.csv", number % 7), number.to_string()).unwrap());
            is_over.store(true, std::sync::atomic::Ordering::Relaxed);
        });
        while !is_over.load(std::sync::atomic::Ordering::Relaxed) {
            let there: Vec<String> = names(root.path()).into_iter().filter(|n| temporary::is_temporary(n)).collect();
            let listed = fs::read_to_string(root.path().join(MANIFEST)).unwrap();
            there.iter().for_each(|name| assert!(listed.contains(name.as_str()), "nobody would know {name}"));
        }
    });
    drop(folder.hold()); // as at an interruption
    let listed = fs::read_to_string(root.path().join(MANIFEST)).unwrap();
    assert!(listed.contains("6.csv") && !listed.contains(PART) && listed.contains("# unfinished"), "{listed}");
}

#[test]
fn a_list_that_was_only_begun_is_begun_again() {
    for begun in ["", "# fisura.mani", "# fisura.manifest/1 ver"] {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join(MANIFEST), begun).unwrap();
        open(root.path()).write("a.csv", "1").unwrap();
        assert_eq!(open(root.path()).files(), ["a.csv"], "{begun:?}");
    }
    for other in ["mine", "# mine\n"] {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join(MANIFEST), other).unwrap();
        assert!(OutputFolder::open(root.path(), "verify").is_err(), "{other:?}");
    }
}

#[test]
fn the_mark_comes_before_and_verdicts_go_before_what_they_are_about() {
    let sorted = ["a.csv", "bench.json", "junit.xml", "part.json", "report.html", "results.json", "summary.md"];
    let order = in_order_of_removal(sorted.map(String::from).to_vec());
    assert_eq!(order[5..], ["a.csv", "part.json"]);
    let root = tempfile::tempdir().unwrap();
    let folder = open(root.path());
    ["deep/a.csv", "results.json"].iter().for_each(|name| folder.write(name, "1").unwrap());
    folder.finish().unwrap();
    let marked = || fs::read_to_string(root.path().join(MANIFEST)).unwrap().contains("# unfinished");
    assert!(!marked());
    folder.begin(|_| marked()).unwrap(); // asked for before anything happens
    assert!(marked() && names(root.path()).is_empty());
}

#[cfg(unix)]
#[test]
fn a_file_of_the_user_in_place_of_the_lock_keeps_its_content() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("mine"), "mine").unwrap();
    let folder = root.path().join("out");
    fs::create_dir(&folder).unwrap();
    fs::hard_link(root.path().join("mine"), folder.join(lock::LOCK)).unwrap();
    assert!(OutputFolder::open(&folder, "verify").is_err(), "it has a second name");
    fs::remove_file(folder.join(lock::LOCK)).unwrap();
    fs::create_dir(folder.join(lock::LOCK)).unwrap();
    assert!(OutputFolder::open(&folder, "verify").is_err(), "it is a folder");
    fs::remove_dir(folder.join(lock::LOCK)).unwrap();
    fs::write(folder.join(lock::LOCK), "mine").unwrap();
    fs::write(folder.join("notes.txt"), "mine").unwrap();
    assert!(OutputFolder::open(&folder, "verify").is_err(), "the folder is not ours");
    for name in ["mine", "out/.fisura.lock", "out/notes.txt"] {
        assert_eq!(fs::read_to_string(root.path().join(name)).unwrap(), "mine", "{name}");
    }
}

/// A process that is being started has all open files for a moment: the lock must not outlive the folder with
/// it.
#[test]
fn a_lock_ends_with_its_folder_though_another_process_has_the_file() {
    let root = tempfile::tempdir().unwrap();
    let folder = open(root.path());
    let inherited = folder.lock.as_ref().map(|lock| lock.try_clone().unwrap());
    drop(folder);
    drop(open(root.path()));
    drop(inherited);
}
