//! A study that is interrupted and continued.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// What a program said on its way out.
pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A study and one with other settings, each into a directory.
pub struct Interrupted<'a> {
    /// The command.
    pub study: &'a dyn Fn(&Path) -> Command,
    /// The same with other settings.
    pub other: &'a dyn Fn(&Path) -> Command,
    /// What the other one is told of the directory.
    pub refusal: &'a str,
    /// File of what is finished.
    pub journal: &'a str,
    /// Files of the complete study; the first one is not there before.
    pub files: &'a [&'a str],
}

impl Interrupted<'_> {
    /// Ctrl-C in the middle keeps what is finished, refuses another study there, and leads to the same bytes in the end.
    pub fn goes_on_to_the_same_result(&self) {
        let place = tempfile::tempdir().unwrap();
        let (whole, parts) = (place.path().join("whole"), place.path().join("parts"));
        assert!((self.study)(&whole).output().unwrap().status.success());
        let journal = parts.join(self.journal);
        let child = (self.study)(&parts).stderr(Stdio::piped()).spawn().unwrap();
        let has_rows = || fs::read_to_string(&journal).is_ok_and(|text| text.contains("\nend\n"));
        while !has_rows() {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        let number = child.id().to_string();
        Command::new("kill")
            .args(["-INT", &number])
            .status()
            .unwrap();
        let interrupted = child.wait_with_output().unwrap();
        assert_eq!(
            interrupted.status.code(),
            Some(130),
            "{}",
            said(&interrupted)
        );
        assert!(has_rows() && !parts.join(self.files[0]).exists());
        let other = (self.other)(&parts).output().unwrap();
        assert_eq!(other.status.code(), Some(2));
        assert!(said(&other).contains(self.refusal), "{}", said(&other));
        let continued = (self.study)(&parts).output().unwrap();
        assert!(continued.status.success(), "{}", said(&continued));
        let told = String::from_utf8_lossy(&continued.stdout).into_owned();
        assert!(
            told.contains("kept from before") && !told.contains(" 0 r"),
            "{told}"
        );
        for name in self.files {
            let [whole, parts] = [&whole, &parts].map(|place| fs::read(place.join(name)).unwrap());
            assert!(whole == parts, "{name} differs");
        }
        assert!(!journal.exists());
    }
}
