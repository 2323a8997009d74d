//! What is written, what stays, and who may write.

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
fn a_folder_in_place_of_a_file_is_refused_before_anything_is_removed() {
    let root = tempfile::tempdir().unwrap();
    let folder = open(root.path());
    for name in ["a.csv", "b.csv"] {
        folder.write(name, "1").unwrap();
    }
    fs::remove_file(root.path().join("b.csv")).unwrap();
    fs::create_dir(root.path().join("b.csv")).unwrap();
    let error = folder.begin(|_| false).unwrap_err();
    assert!(error.message.contains("in place of files of this program: b.csv"), "{error:?}");
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
    assert!(error.message.contains("is not empty and has no fisura.files"), "{error:?}");
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
    folder.write("series/a.csv", "1").unwrap();
    let copy = killed(&folder);
    assert!(fs::read_to_string(copy.path().join(MANIFEST)).unwrap().contains("# unfinished"));
    for part in [PART, "series/.fisura.part"] {
        fs::write(copy.path().join(part), "half").unwrap();
    }
    fs::write(copy.path().join(".fisura-mine.part"), "mine").unwrap();
    let next = open(copy.path());
    assert_eq!(names(copy.path()), [".fisura-mine.part", "checkpoint.bin", "series"], "what was begun is gone");
    assert_eq!(names(&copy.path().join("series")), ["a.csv"]);
    assert_eq!(next.files(), ["checkpoint.bin", "series/a.csv"]);
    next.write("checkpoint.bin", "3").unwrap();
    next.finish().unwrap();
    assert!(!fs::read_to_string(copy.path().join(MANIFEST)).unwrap().contains("# unfinished"));
}

/// A name is listed before its file is there: who is killed in between leaves nothing that nobody knows.
#[test]
fn a_name_without_a_file_is_no_obstacle_and_a_list_that_was_only_begun_neither() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join(PART), "# fisura.fil").unwrap();
    open(root.path()).write("a.csv", "1").unwrap();
    fs::remove_file(root.path().join("a.csv")).unwrap();
    let folder = open(root.path());
    assert_eq!((folder.files(), folder.read("a.csv")), (vec!["a.csv".to_string()], None));
    folder.begin(|_| false).unwrap();
    assert!(folder.files().is_empty());
    for other in ["mine", "# mine\n", ""] {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join(MANIFEST), other).unwrap();
        assert!(OutputFolder::open(root.path(), "verify").is_err(), "{other:?}");
    }
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
    assert_eq!(fs::read_to_string(path.join("rows.csv")).unwrap(), "a\n1\n2\n3\n");
}

#[test]
fn names_that_lead_out_of_the_folder_are_refused() {
    let root = tempfile::tempdir().unwrap();
    let folder = open(&root.path().join("out"));
    for name in ["../a", "/a", "series/../../a", "", "."] {
        assert!(folder.write(name, "x").is_err(), "{name:?}");
    }
    assert_eq!(names(root.path()), ["out"]);
    assert!([MANIFEST, lock::LOCK, PART, "a/.fisura.part"].iter().all(|name| folder.write(name, "x").is_err()));
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
fn files_written_at_once_are_all_listed_and_whole() {
    let root = tempfile::tempdir().unwrap();
    let folder = open(root.path());
    folder.begin(|_| false).unwrap();
    std::thread::scope(|scope| {
        for thread in 0..4 {
            let write = move |number: usize| (format!("{}/{thread}.csv", number % 7), number.to_string());
            let folder = &folder;
            scope.spawn(move || (0..50).map(write).for_each(|(name, text)| folder.write(&name, text).unwrap()));
        }
    });
    drop(folder.hold()); // as at an interruption
    assert_eq!(folder.files().len(), 28);
    assert!(folder.files().iter().all(|name| folder.read(name).is_some()), "{:?}", folder.files());
    assert!(fs::read_to_string(root.path().join(MANIFEST)).unwrap().contains("# unfinished"));
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
