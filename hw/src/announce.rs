//! What the robot says to people (S3 section 3), and how it is heard.
//!
//! An announcement is an event on standard output, one line of JSON. It is spoken by a command of
//! the user's, such as `espeak-ng`, which gets the words as its last argument. If there is none, or
//! it fails, the base beeps (ARCOS `SAY`).

use serde_json::json;
use sidestep::interact::Announcement;
use std::io::Write;
use std::process::{Child, Command, Stdio};

/// A beep as `SAY` takes it: pairs of a duration in units of 20 ms and a tone in half cycles, 0
/// being silence.
#[must_use]
pub const fn beeps(announcement: Announcement) -> &'static [u8] {
    const TONE: u8 = 50;
    match announcement {
        // A long one.
        Announcement::RobotInPath => &[30, TONE],
        // Three short ones.
        Announcement::Interact => &[8, TONE, 8, 0, 8, TONE, 8, 0, 8, TONE],
        // Long, short, long.
        Announcement::NoFreePath => &[25, TONE, 8, 0, 8, TONE, 8, 0, 25, TONE],
    }
}

/// Says things, one after the other.
#[derive(Debug)]
pub struct Announcer {
    command: Vec<String>,
    speaking: Option<(Announcement, Child)>,
    next: Option<Announcement>,
}

impl Announcer {
    /// An announcer that speaks by `command`, its words separated by spaces; none only beeps. No
    /// shell is involved.
    #[must_use]
    pub fn new(command: Option<&str>) -> Self {
        let words = command.unwrap_or_default().split_whitespace();
        Self {
            command: words.map(str::to_owned).collect(),
            speaking: None,
            next: None,
        }
    }

    /// Says something at the time `t`, ms: writes the event, and speaks as soon as what was said
    /// before has been. Gives what the base is to beep, if it is to.
    ///
    /// Only the latest of what waits is spoken: it is what holds.
    pub fn say(
        &mut self,
        announcement: Announcement,
        t: u64,
        out: &mut impl Write,
    ) -> Option<&'static [u8]> {
        // Nobody reading any more is no reason to be silent.
        let _ = writeln!(out, "{}", json!({"t": t, "say": announcement.text()}))
            .and_then(|()| out.flush());
        self.next = Some(announcement);
        self.poll()
    }

    /// Looks after what is being spoken; to be called now and then. Gives what the base is to beep
    /// because speaking has failed.
    pub fn poll(&mut self) -> Option<&'static [u8]> {
        let mut beep = None;
        if let Some((announcement, child)) = &mut self.speaking {
            match child.try_wait() {
                Ok(None) => return None,
                Ok(Some(status)) if status.success() => {}
                Ok(Some(_)) | Err(_) => beep = Some(beeps(*announcement)),
            }
            self.speaking = None;
        }
        if let Some(announcement) = self.next.take() {
            match self.speak(announcement) {
                Some(child) => self.speaking = Some((announcement, child)),
                None => beep = Some(beeps(announcement)),
            }
        }
        beep
    }

    /// Nothing is being spoken, and nothing waits to be.
    #[must_use]
    pub const fn is_quiet(&self) -> bool {
        self.speaking.is_none() && self.next.is_none()
    }

    fn speak(&self, announcement: Announcement) -> Option<Child> {
        let (program, arguments) = self.command.split_first()?;
        Command::new(program)
            .args(arguments)
            .arg(announcement.text())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .ok()
    }
}

impl Drop for Announcer {
    /// Lets nobody talk on after the program has ended.
    fn drop(&mut self) {
        if let Some((_, child)) = &mut self.speaking {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}
