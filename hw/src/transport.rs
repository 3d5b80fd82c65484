//! The byte stream to the robot: a serial port or a TCP connection.

use std::error::Error;
use std::fmt;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

use serialport::{ClearBuffer, SerialPort};

/// The TCP port on which simulators and serial-to-Ethernet bridges of this protocol listen.
pub const DEFAULT_TCP_PORT: u16 = 8101;
/// The baud rate at which a serial port is opened; the session sets the one it wants to try.
const OPENING_BAUD: u32 = 9600;
/// How long a read waits for a first byte.
const READ_TIMEOUT: Duration = Duration::from_millis(10);
/// How long a write may be held up before the port counts as dead.
const WRITE_TIMEOUT: Duration = Duration::from_millis(500);
/// How long a TCP connection may take to be made.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(3);
/// The most stale input that is thrown away at once: a peer that sends faster than it is read must
/// not hold the caller up for ever.
const DISCARD_LIMIT: usize = 1 << 16;

/// A port could not be used.
#[derive(Debug)]
pub struct TransportError {
    port: String,
    action: &'static str,
    cause: io::Error,
}

impl fmt::Display for TransportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: cannot {}: {}", self.port, self.action, self.cause)
    }
}

impl Error for TransportError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        Some(&self.cause)
    }
}

/// A byte stream in both directions. A port that vanishes is an error, never silence.
pub trait Transport: Send {
    /// Reads what has arrived, waiting no longer than 10 ms for it. 0 means that nothing has.
    ///
    /// # Errors
    /// If the port fails, or the peer has closed it.
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, TransportError>;

    /// Writes all of `bytes`.
    ///
    /// # Errors
    /// If the port fails, or takes nothing for half a second.
    fn write_all(&mut self, bytes: &[u8]) -> Result<(), TransportError>;

    /// Changes the baud rate once what was written has left; without effect where there is none.
    ///
    /// # Errors
    /// If the port fails, or does not have that rate.
    fn set_baud(&mut self, baud: u32) -> Result<(), TransportError>;

    /// Throws away what has arrived but was not read.
    ///
    /// # Errors
    /// If the port fails.
    fn discard_input(&mut self) -> Result<(), TransportError>;

    /// Whether the stream has a baud rate, so that the session has to look for it.
    fn has_baud(&self) -> bool;

    /// The port, as the user named it.
    fn describe(&self) -> &str;
}

/// Opens a port: `tcp:HOST` or `tcp:HOST:PORT` for a TCP connection, else the path or name of a
/// serial port.
///
/// # Errors
/// If there is no such port, or it is in use, or nobody listens there.
pub fn open(port: &str) -> Result<Box<dyn Transport>, TransportError> {
    Ok(match port.strip_prefix("tcp:") {
        Some(address) => Box::new(open_tcp(port, address)?),
        None => Box::new(open_serial(port)?),
    })
}

/// Whether an error only says that nothing happened in the time allowed.
fn is_pause(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted
    )
}

fn read_some(stream: &mut impl Read, buffer: &mut [u8]) -> io::Result<usize> {
    match stream.read(buffer) {
        Ok(0) if !buffer.is_empty() => Err(io::Error::new(
            ErrorKind::UnexpectedEof,
            "closed by the peer",
        )),
        Err(error) if is_pause(error.kind()) => Ok(0),
        result => result,
    }
}

fn write_everything(stream: &mut impl Write, mut bytes: &[u8]) -> io::Result<()> {
    let deadline = Instant::now() + WRITE_TIMEOUT;
    while !bytes.is_empty() {
        match stream.write(bytes) {
            Ok(0) => return Err(ErrorKind::WriteZero.into()),
            Ok(written) => bytes = bytes.get(written..).unwrap_or_default(),
            Err(error) if is_pause(error.kind()) && Instant::now() < deadline => {}
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

/// A stream with the name by which its errors are told.
struct Port<S> {
    name: String,
    stream: S,
}

impl<S> Port<S> {
    fn failed(&self, action: &'static str, cause: impl Into<io::Error>) -> TransportError {
        failed(&self.name, action, cause)
    }
}

fn failed(port: &str, action: &'static str, cause: impl Into<io::Error>) -> TransportError {
    TransportError {
        port: port.to_owned(),
        action,
        cause: cause.into(),
    }
}

/// Opens a serial port with 8 data bits, no parity, one stop bit and no flow control.
fn open_serial(name: &str) -> Result<Port<Box<dyn SerialPort>>, TransportError> {
    let stream = serialport::new(name, OPENING_BAUD)
        .timeout(READ_TIMEOUT)
        .open()
        .map_err(|cause| failed(name, "open", cause))?;
    Ok(Port {
        name: name.to_owned(),
        stream,
    })
}

impl Transport for Port<Box<dyn SerialPort>> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, TransportError> {
        read_some(&mut self.stream, buffer).map_err(|cause| self.failed("read", cause))
    }

    fn write_all(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
        write_everything(&mut self.stream, bytes).map_err(|cause| self.failed("write", cause))
    }

    fn set_baud(&mut self, baud: u32) -> Result<(), TransportError> {
        self.stream
            .flush()
            .map_err(|cause| self.failed("write", cause))?;
        self.stream
            .set_baud_rate(baud)
            .map_err(|cause| self.failed("set the baud rate", cause))
    }

    fn discard_input(&mut self) -> Result<(), TransportError> {
        self.stream
            .clear(ClearBuffer::Input)
            .map_err(|cause| self.failed("discard input", cause))
    }

    fn has_baud(&self) -> bool {
        true
    }

    fn describe(&self) -> &str {
        &self.name
    }
}

fn open_tcp(name: &str, address: &str) -> Result<Port<TcpStream>, TransportError> {
    let connect = || {
        let stream = connect(address)?;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(READ_TIMEOUT))?;
        stream.set_write_timeout(Some(WRITE_TIMEOUT))?;
        Ok::<_, io::Error>(stream)
    };
    let stream = connect().map_err(|cause| failed(name, "connect", cause))?;
    Ok(Port {
        name: name.to_owned(),
        stream,
    })
}

/// Connects to the first address that answers.
fn connect(address: &str) -> io::Result<TcpStream> {
    let has_port = address.contains(':') && !address.ends_with(']');
    let candidates: Vec<_> = if has_port {
        address.to_socket_addrs()?.collect()
    } else {
        let host = address.trim_start_matches('[').trim_end_matches(']');
        (host, DEFAULT_TCP_PORT).to_socket_addrs()?.collect()
    };
    let mut last = io::Error::new(ErrorKind::NotFound, "the name has no address");
    for candidate in candidates {
        match TcpStream::connect_timeout(&candidate, CONNECT_TIMEOUT) {
            Ok(stream) => return Ok(stream),
            Err(error) => last = error,
        }
    }
    Err(last)
}

impl Transport for Port<TcpStream> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, TransportError> {
        read_some(&mut self.stream, buffer).map_err(|cause| self.failed("read", cause))
    }

    fn write_all(&mut self, bytes: &[u8]) -> Result<(), TransportError> {
        write_everything(&mut self.stream, bytes).map_err(|cause| self.failed("write", cause))
    }

    fn set_baud(&mut self, _baud: u32) -> Result<(), TransportError> {
        Ok(())
    }

    fn discard_input(&mut self) -> Result<(), TransportError> {
        let mut discard = || {
            self.stream.set_nonblocking(true)?;
            let mut buffer = [0; 1024];
            let mut discarded = 0;
            while discarded < DISCARD_LIMIT {
                match read_some(&mut self.stream, &mut buffer)? {
                    0 => break,
                    count => discarded += count,
                }
            }
            self.stream.set_nonblocking(false)
        };
        discard().map_err(|cause| self.failed("discard input", cause))
    }

    fn has_baud(&self) -> bool {
        false
    }

    fn describe(&self) -> &str {
        &self.name
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::TcpListener;

    /// Reads until something comes.
    fn read(transport: &mut dyn Transport) -> Result<Vec<u8>, TransportError> {
        let mut buffer = [0; 64];
        for _ in 0..200 {
            let count = transport.read(&mut buffer)?;
            if count > 0 {
                return Ok(buffer[..count].to_vec());
            }
        }
        Ok(Vec::new())
    }

    #[test]
    fn a_connection_carries_bytes_and_says_when_it_ends() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let name = format!("tcp:{}", listener.local_addr().unwrap());
        let mut transport = open(&name).unwrap();
        let (mut peer, _) = listener.accept().unwrap();
        assert!(!transport.has_baud());
        assert_eq!(transport.describe(), name);
        assert_eq!(transport.read(&mut [0; 8]).unwrap(), 0);

        peer.write_all(b"robot").unwrap();
        assert_eq!(read(&mut *transport).unwrap(), b"robot");
        transport.write_all(b"host").unwrap();
        let mut heard = [0; 4];
        peer.read_exact(&mut heard).unwrap();
        assert_eq!(&heard, b"host");

        peer.write_all(b"stale").unwrap();
        std::thread::sleep(READ_TIMEOUT);
        transport.discard_input().unwrap();
        transport.set_baud(38_400).unwrap();
        peer.write_all(b"fresh").unwrap();
        assert_eq!(read(&mut *transport).unwrap(), b"fresh");

        drop(peer);
        let error = read(&mut *transport).unwrap_err();
        assert_eq!(
            error.to_string(),
            format!("{name}: cannot read: closed by the peer")
        );
    }

    #[test]
    fn a_port_that_is_not_there_is_named() {
        let free = TcpListener::bind("127.0.0.1:0")
            .unwrap()
            .local_addr()
            .unwrap();
        for port in [&*format!("tcp:{free}"), "tcp:[::1", "/dev/no-such-port"] {
            let error = open(port).err().unwrap().to_string();
            assert!(error.starts_with(&format!("{port}: cannot ")), "{error}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_serial_port_carries_bytes_and_says_when_it_vanishes() {
        use serialport::TTYPort;

        let (mut peer, port) = TTYPort::pair().unwrap();
        let name = port.name().unwrap();
        drop(port);
        peer.set_timeout(READ_TIMEOUT).unwrap();
        let mut transport = open(&name).unwrap();
        assert!(transport.has_baud());
        for baud in [38_400, 115_200, 9600] {
            transport.set_baud(baud).unwrap();
        }

        // Not a byte is changed on the way, line ends and control characters included.
        let all: Vec<u8> = (0..=255).collect();
        transport.write_all(&all).unwrap();
        let mut heard = vec![0; 256];
        peer.read_exact(&mut heard).unwrap();
        assert_eq!(heard, all);
        peer.write_all(&all).unwrap();
        let mut heard = Vec::new();
        while heard.len() < 256 {
            heard.extend(read(&mut *transport).unwrap());
        }
        assert_eq!(heard, all);

        peer.write_all(b"stale").unwrap();
        transport.discard_input().unwrap();
        peer.write_all(b"fresh").unwrap();
        assert_eq!(read(&mut *transport).unwrap(), b"fresh");

        drop(peer);
        let error = read(&mut *transport).unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("{name}: cannot read: ")),
            "{error}"
        );
        assert!(transport.write_all(b"host").is_err());
    }
}
