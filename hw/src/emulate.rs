//! The robot's side in real time: a simulated robot on a pseudo-terminal or a TCP port.

use crate::drive::Clock;
use serialport::{SerialPort, TTYPort};
use sidestep_sim::Simulation;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Where hosts reach the simulated robot.
pub enum Line {
    /// The master side of a pseudo-terminal; hosts open the slave.
    Pty(TTYPort),
    /// A TCP port, with the host that is connected, if one is.
    Tcp(TcpListener, Option<TcpStream>),
}

impl Line {
    /// A pseudo-terminal, and the path by which a host opens it.
    ///
    /// # Errors
    /// If the system gives none.
    pub fn pty() -> io::Result<(Self, String)> {
        let (mut master, slave) = TTYPort::pair()?;
        let path = slave
            .name()
            .ok_or_else(|| io::Error::other("the pseudo-terminal has no name"))?;
        master.set_timeout(Duration::from_millis(1))?;
        Ok((Self::Pty(master), path))
    }

    /// A TCP port to listen on.
    ///
    /// # Errors
    /// If it cannot be listened on.
    pub fn tcp(address: &str) -> io::Result<(Self, String)> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?.to_string();
        Ok((Self::Tcp(listener, None), address))
    }

    /// Reads what a host has sent; `None` if no host is there.
    fn read(&mut self, buffer: &mut [u8]) -> Option<usize> {
        match self {
            // Without a host the master reads an I/O error.
            Self::Pty(port) => match port.read(buffer) {
                Ok(count) => Some(count),
                Err(error) if error.kind() == ErrorKind::TimedOut => Some(0),
                Err(_) => {
                    std::thread::sleep(Duration::from_millis(1));
                    None
                }
            },
            Self::Tcp(listener, host) => {
                if let Ok((stream, _)) = listener.accept() {
                    let ready = stream
                        .set_nonblocking(true)
                        .and_then(|()| stream.set_nodelay(true));
                    *host = ready.ok().map(|()| stream);
                }
                std::thread::sleep(Duration::from_millis(1));
                match host.as_mut()?.read(buffer) {
                    Err(error) if error.kind() == ErrorKind::WouldBlock => Some(0),
                    Ok(count) if count > 0 => Some(count),
                    _ => {
                        *host = None;
                        None
                    }
                }
            }
        }
    }

    /// Writes to the host. What no host takes is lost, as on a real line.
    fn write(&mut self, bytes: &[u8]) {
        let _ = match self {
            Self::Pty(port) => port.write_all(bytes),
            Self::Tcp(_, Some(host)) => host.write_all(bytes),
            Self::Tcp(_, None) => Ok(()),
        };
    }
}

/// A name for a pseudo-terminal, removed when dropped.
pub struct Link<'a>(&'a Path);

impl<'a> Link<'a> {
    /// Makes `path` a symbolic link to the pseudo-terminal `pty`, in place of an older such link.
    ///
    /// # Errors
    /// If the link cannot be made, or `path` is something else than a link.
    pub fn new(path: &'a Path, pty: &str) -> io::Result<Self> {
        match std::fs::symlink_metadata(path) {
            Ok(data) if data.is_symlink() => std::fs::remove_file(path)?,
            Ok(_) => {
                return Err(io::Error::new(
                    ErrorKind::AlreadyExists,
                    "there is a file of that name",
                ));
            }
            Err(_) => {}
        }
        std::os::unix::fs::symlink(pty, path)?;
        Ok(Self(path))
    }
}

impl Drop for Link<'_> {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(self.0);
    }
}

/// Runs the simulation in step with the clock until `done`, and hands it back.
pub fn serve(
    mut simulation: Simulation,
    mut line: Line,
    clock: Clock,
    done: &AtomicBool,
) -> Simulation {
    let mut buffer = [0; 4096];
    let mut connected = false;
    while !done.load(Ordering::Relaxed) {
        let received = line.read(&mut buffer);
        simulation.advance_to(clock.now());
        match received {
            Some(count) => {
                connected = true;
                simulation
                    .robot_mut()
                    .receive(buffer.get(..count).unwrap_or_default());
            }
            None if connected => {
                connected = false;
                simulation.robot_mut().hang_up();
            }
            None => {}
        }
        let bytes = simulation.robot_mut().transmit();
        if connected && !bytes.is_empty() {
            line.write(&bytes);
        }
    }
    simulation
}
