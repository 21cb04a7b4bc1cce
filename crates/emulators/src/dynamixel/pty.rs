//! A serial line that ends in this process.

use std::fs::File;
use std::io::{self, Read, Write};
use std::os::unix::ffi::OsStringExt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

/// A pseudo-terminal: what a client opens as a serial port, and this end of it.
#[derive(Debug)]
pub(super) struct Pty {
    ours: File,
    path: PathBuf,
    /// Held open, so that the line stays while clients come and go.
    _theirs: File,
}

impl Pty {
    /// A new line, raw.
    pub(super) fn open() -> io::Result<Self> {
        let ours = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        grantpt(&ours)?;
        unlockpt(&ours)?;
        let name = std::ffi::OsString::from_vec(ptsname(&ours, Vec::new())?.into_bytes());
        let path = PathBuf::from(name);
        let theirs = rustix::fs::open(
            &path,
            rustix::fs::OFlags::RDWR | rustix::fs::OFlags::NOCTTY | rustix::fs::OFlags::CLOEXEC,
            rustix::fs::Mode::empty(),
        )?;
        let mut settings = tcgetattr(&theirs)?;
        settings.make_raw();
        tcsetattr(&theirs, OptionalActions::Now, &settings)?;
        // Where nobody reads, answers are lost as they are on a wire; nothing waits.
        rustix::io::ioctl_fionbio(&ours, true)?;
        Ok(Self { ours: ours.into(), path, _theirs: theirs.into() })
    }

    /// What clients open.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// The speed that the client set, bits per second.
    pub(super) fn speed(&self) -> Option<u32> {
        tcgetattr(&self.ours).ok().map(|settings| settings.output_speed())
    }

    /// Bytes, as soon as some are there; none after `patience`.
    pub(super) fn read(&mut self, bytes: &mut [u8], patience: Duration) -> io::Result<usize> {
        let mut waiting = [PollFd::new(&self.ours, PollFlags::IN)];
        let patience = Timespec { tv_sec: 0, tv_nsec: patience.subsec_nanos().into() };
        match poll(&mut waiting, Some(&patience)) {
            Ok(0) | Err(rustix::io::Errno::INTR) => Ok(0),
            Ok(_) => match self.ours.read(bytes) {
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => Ok(0),
                read => read,
            },
            Err(error) => Err(error.into()),
        }
    }

    /// Sends bytes, unless nobody takes them.
    pub(super) fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        match self.ours.write_all(bytes) {
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => Ok(()),
            written => written,
        }
    }
}
