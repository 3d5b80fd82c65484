//! The control loop in real time: one thread, one port.

use crate::pilot::Pilot;
use crate::session::Output;
use crate::transport::{Transport, TransportError};
use sidestep::avoid::{contact_time_bound, time_to_collision};
use sidestep::failsafe::Action;
use sidestep::law::Law;
use sidestep::quantity::{Angle, Length, Speed};
use sidestep::view::View;
use std::f32::consts::FRAC_PI_2;
use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// A clock in ms since it was made, running `speed` times as fast as the wall's.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    start: Instant,
    speed: f64,
}

impl Clock {
    /// A clock that starts now.
    #[must_use]
    pub fn new(speed: f64) -> Self {
        Self {
            start: Instant::now(),
            speed,
        }
    }

    /// Its time in ms.
    #[must_use]
    pub fn now(&self) -> u64 {
        (self.start.elapsed().as_secs_f64() * 1000.0 * self.speed) as u64
    }
}

/// When a run ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The goal was reached.
    Arrived,
    /// The operator asked for it.
    Operator,
    /// The time was over.
    TimeLimit,
    /// The session ended by itself.
    Closed,
}

/// What people ask of a run while it lasts.
#[derive(Debug, Default)]
pub struct Signals {
    /// End it.
    pub interrupted: AtomicBool,
    /// Let the robot go on after a latched stop.
    pub reset: AtomicBool,
}

impl Signals {
    /// Nothing asked yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            interrupted: AtomicBool::new(false),
            reset: AtomicBool::new(false),
        }
    }

    /// Takes the lines of standard input: `reset` asks for a reset. Returns when input ends.
    pub fn listen(&self) {
        for line in std::io::stdin().lines().map_while(Result::ok) {
            if line.trim() == "reset" {
                self.reset.store(true, Ordering::Relaxed);
            }
        }
    }
}

/// How a run is shown: a line that is rewritten on a terminal, else a line now and then.
pub struct Status {
    terminal: bool,
    shown: Option<String>,
    shown_at: u64,
}

impl Default for Status {
    fn default() -> Self {
        Self {
            terminal: std::io::stdout().is_terminal(),
            shown: None,
            shown_at: 0,
        }
    }
}

impl Status {
    /// A line to keep.
    pub fn keep(&mut self, line: &str) {
        let clear = if self.terminal && self.shown.take().is_some() {
            "\r\x1b[K"
        } else {
            ""
        };
        put(&format!("{clear}{line}\n"));
    }

    /// The line of the moment. `key` tells lines apart that are worth showing at once.
    fn show(&mut self, now: u64, key: &str, line: &str) {
        let changed = self.shown.as_deref() != Some(key);
        if self.terminal {
            put(&format!("\r\x1b[K{line}"));
        } else if changed || now >= self.shown_at + 5000 {
            put(&format!("{line}\n"));
        } else {
            return;
        }
        self.shown = Some(key.to_owned());
        self.shown_at = now;
    }
}

/// Writes to standard output. Nobody looking any more (a closed pipe) is no reason to let go of a
/// robot that is under way.
fn put(text: &str) {
    let mut out = std::io::stdout();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}

/// S1 E4 for people to read: the time to collision with the obstacle ahead as the paper reckons it,
/// and the bound before which no contact can happen.
fn times<const N: usize>(view: &View<N>) -> Option<String> {
    let obstacle = view.obstacle.as_ref()?;
    let ahead = Angle::radians(FRAC_PI_2).ok()?;
    let speed = Speed::metres_per_second(view.speed.abs()).ok()?;
    let contact = Length::metres(obstacle.contact_range.max(0) as f32 / 1000.0).ok()?;
    let bearing = obstacle.direction.minus(view.pose.heading);
    let show = |time: Option<f32>| {
        time.filter(|time| *time < 100.0)
            .map_or_else(|| "-".to_owned(), |time| format!("{time:.1} s"))
    };
    Some(format!(
        ", collision in {} (contact not before {})",
        show(time_to_collision(
            obstacle.distance,
            ahead,
            bearing,
            speed,
            obstacle.speed.value,
            ahead
        )),
        show(contact_time_bound(
            obstacle.distance,
            contact,
            speed,
            obstacle.speed.value
        )),
    ))
}

fn show<L: Law<N>, const N: usize>(status: &mut Status, pilot: &mut Pilot<L, N>, now: u64) {
    while let Some((t, text)) = pilot.next_event() {
        status.keep(&format!("{:8.1} s  {text}", t as f64 / 1000.0));
    }
    let Some(decision) = pilot.latest() else {
        return;
    };
    let nearest = decision.view.map_or_else(
        || "     ?".to_owned(),
        |view| {
            let nearest = view
                .hazard
                .iter()
                .map(|hazard| hazard.range)
                .min()
                .unwrap_or(0);
            format!("{:4.2} m", f64::from(nearest) / 1000.0)
        },
    );
    let (state, reason) = match (&decision.stop, &decision.limit) {
        (Some(stop), _) if decision.action == Action::LatchedStop => {
            ("LATCHED", format!("{stop}; type `reset` to go on"))
        }
        (Some(stop), _) => ("STOP", stop.to_string()),
        (None, Some(limit)) => (decision.mode, format!("limited: {limit}")),
        (None, None) => (decision.mode, String::new()),
    };
    let key = match &decision.stop {
        Some(stop) => stop.row().cause,
        None => decision.mode,
    };
    let times = decision.view.as_ref().and_then(times).unwrap_or_default();
    let line = format!(
        "{:8.1} s  {state:<9} v {:4} mm/s  turn {:5} mrad/s  nearest echo {nearest}{times}  {reason}",
        now as f64 / 1000.0,
        decision.command.speed(),
        decision.command.turn_rate(),
    );
    status.show(now, key, &line);
}

fn carry_out(transport: &mut dyn Transport, output: Output) -> Result<(), TransportError> {
    match output {
        Output::Send(bytes) => transport.write_all(&bytes),
        Output::SetBaud(baud) => transport.set_baud(baud),
        Output::Discard => transport.discard_input(),
    }
}

/// Drives until the run ends; the robot is stopped and the session closed before it returns.
///
/// `open` opens the port, again after every failure. `limit` is in ms of the clock.
///
/// # Errors
/// If the port cannot be opened to begin with.
pub fn run<L: Law<N>, const N: usize>(
    pilot: &mut Pilot<L, N>,
    open: impl FnMut() -> Result<Box<dyn Transport>, TransportError>,
    clock: Clock,
    limit: Option<u64>,
    signals: &Signals,
    status: &mut Status,
) -> Result<Ending, TransportError> {
    run_attended(pilot, open, clock, limit, signals, status, |_, _| {})
}

/// The same, with something to attend to again and again, at the clock's time in ms: people whom a
/// camera sees, what is to be said.
///
/// # Errors
/// If the port cannot be opened to begin with.
pub fn run_attended<L: Law<N>, const N: usize>(
    pilot: &mut Pilot<L, N>,
    mut open: impl FnMut() -> Result<Box<dyn Transport>, TransportError>,
    clock: Clock,
    limit: Option<u64>,
    signals: &Signals,
    status: &mut Status,
    mut attend: impl FnMut(&mut Pilot<L, N>, u64),
) -> Result<Ending, TransportError> {
    let mut port = Some(open()?);
    let mut retry_at = 0;
    let mut ending = None;
    let mut closing_since = 0;
    let mut buffer = [0; 4096];
    loop {
        let now = clock.now();
        attend(pilot, now);
        match &mut port {
            Some(transport) => {
                let step = || -> Result<(), TransportError> {
                    let count = transport.read(&mut buffer)?;
                    let begun = Instant::now();
                    let now = clock.now();
                    if let Some(bytes) = buffer.get(..count)
                        && !bytes.is_empty()
                    {
                        pilot.receive(bytes, now);
                    }
                    while let Some(output) = pilot.poll(now) {
                        carry_out(transport.as_mut(), output)?;
                    }
                    pilot.measured(begun.elapsed().as_micros() as u64);
                    Ok(())
                };
                if let Err(error) = { step }() {
                    pilot.transport_lost(&error.to_string(), now);
                    port = None;
                    retry_at = now + 1000;
                }
            }
            None => {
                std::thread::sleep(Duration::from_millis(10));
                if now >= retry_at {
                    match open() {
                        Ok(transport) => {
                            port = Some(transport);
                            pilot.transport_restored(now);
                        }
                        Err(_) => retry_at = now + 1000,
                    }
                }
            }
        }
        if signals.reset.swap(false, Ordering::Relaxed) {
            pilot.reset(now);
        }
        show(status, pilot, now);

        if ending.is_none() {
            ending = if signals.interrupted.load(Ordering::Relaxed) {
                Some(Ending::Operator)
            } else if pilot.tally().arrived.is_some() {
                Some(Ending::Arrived)
            } else if limit.is_some_and(|limit| now >= limit) {
                Some(Ending::TimeLimit)
            } else if pilot.session().is_closed() {
                return Ok(Ending::Closed);
            } else {
                None
            };
            if ending.is_some() {
                closing_since = now;
                pilot.close(now);
            }
        } else if let Some(ending) = ending
            && (pilot.session().is_closed() || port.is_none() || now >= closing_since + 3000)
        {
            show(status, pilot, now);
            return Ok(ending);
        }
    }
}
