//! Processes that tests wait for. The time here only ends what hangs, on the slowest machine.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::io::Read;
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(300);

/// A process that does not outlive its test.
pub struct Job(Child);

impl Job {
    pub fn start(command: &mut Command) -> Self {
        Self(command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap())
    }

    fn wait_for(&mut self, mut happened: impl FnMut(&mut Child) -> bool) {
        let begin = Instant::now();
        while !happened(&mut self.0) {
            assert!(begin.elapsed() < PATIENCE, "nothing happened");
            sleep(Duration::from_millis(2));
        }
    }

    /// Waits until something has happened, which must be before the process ends.
    pub fn until(&mut self, happened: impl Fn() -> bool) {
        self.wait_for(|child| {
            let happened = happened();
            assert!(happened || child.try_wait().unwrap().is_none(), "the process ended before");
            happened
        });
    }

    /// Sends a signal, which `kill` knows by this name.
    pub fn send(&self, signal: &str) {
        let kill = Command::new("kill").args([signal, &self.0.id().to_string()]).status().unwrap();
        assert!(kill.success());
    }

    /// Kills it; false if it had ended.
    pub fn kill(mut self) -> bool {
        let runs = self.0.try_wait().unwrap().is_none();
        self.0.kill().unwrap();
        self.0.wait().unwrap();
        runs
    }

    /// Waits for the end of a process that writes little.
    pub fn end(mut self) -> Output {
        self.wait_for(|child| child.try_wait().unwrap().is_some());
        let (mut stdout, mut stderr) = (Vec::new(), Vec::new());
        self.0.stdout.take().unwrap().read_to_end(&mut stdout).unwrap();
        self.0.stderr.take().unwrap().read_to_end(&mut stderr).unwrap();
        Output { status: self.0.wait().unwrap(), stdout, stderr }
    }

    /// Sends a signal and waits for the end, which must be that of an interrupted command; returns what it said.
    pub fn interrupt(self, signal: &str) -> String {
        self.send(signal);
        let output = self.end();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(130), "{said}");
        said
    }
}

impl Drop for Job {
    fn drop(&mut self) {
        // It has ended, or is of no use any more.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
