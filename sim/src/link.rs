//! A line between robot and host that loses, delays, duplicates and reorders whole packets.
//!
//! What it does to bytes that are no packets is not its business: bytes that begin no frame are
//! dropped, as a receiver would drop them.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sidestep::arcos::Receiver;

use crate::error::{Error, require};

/// What is wrong with one direction of a line. The default is nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Faults {
    /// Probability that a packet is lost.
    pub loss: f64,
    /// Probability that a packet arrives twice.
    pub duplication: f64,
    /// Greatest delay (ms): each packet takes a random time up to this, in the order sent.
    pub delay_ms: u64,
    /// Probability that a packet is held back, so that later ones overtake it.
    pub reordering: f64,
    /// Greatest time for which it is then held back (ms).
    pub hold_ms: u64,
}

impl Faults {
    fn check(&self) -> Result<(), Error> {
        for (field, probability) in [
            ("link.loss", self.loss),
            ("link.duplication", self.duplication),
            ("link.reordering", self.reordering),
        ] {
            require(field, probability, "0..=1", |p| (0.0..=1.0).contains(&p))?;
        }
        for (field, ms) in [
            ("link.delay_ms", self.delay_ms),
            ("link.hold_ms", self.hold_ms),
        ] {
            require(field, ms as f64, "0..=60000 ms", |t| t <= 60_000.0)?;
        }
        Ok(())
    }
}

/// A packet that has arrived.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Packet {
    /// When that was so which it rests on (ms), as its sender had it.
    pub basis_ms: u64,
    /// Its frame.
    pub bytes: Vec<u8>,
}

/// One direction of a line.
#[derive(Debug, Clone)]
pub struct Link {
    faults: Faults,
    rng: ChaCha8Rng,
    receiver: Receiver,
    /// Packets under way with the time at which each arrives (ms), in the order sent.
    under_way: Vec<(u64, Packet)>,
    /// No packet that is not held back arrives before this (ms).
    earliest: u64,
}

impl Link {
    /// A direction with these faults, which strike as `seed` has it.
    pub fn new(faults: Faults, seed: u64) -> Result<Self, Error> {
        faults.check()?;
        Ok(Self {
            faults,
            rng: ChaCha8Rng::seed_from_u64(seed),
            receiver: Receiver::new(),
            under_way: Vec::new(),
            earliest: 0,
        })
    }

    /// Changes what is wrong, for packets that are sent from now on.
    pub fn set_faults(&mut self, faults: Faults) -> Result<(), Error> {
        faults.check()?;
        self.faults = faults;
        Ok(())
    }

    /// Takes what the sender wrote at `now_ms`, resting on what was so at `basis_ms`.
    pub fn send(&mut self, bytes: &[u8], now_ms: u64, basis_ms: u64) {
        let mut input = bytes;
        let mut receiver = std::mem::take(&mut self.receiver);
        while let Some(frame) = receiver.next_frame(&mut input) {
            self.dispatch(frame.as_bytes(), now_ms, basis_ms);
        }
        self.receiver = receiver;
    }

    fn dispatch(&mut self, frame: &[u8], now_ms: u64, basis_ms: u64) {
        let Faults {
            loss,
            duplication,
            delay_ms,
            reordering,
            hold_ms,
        } = self.faults;
        // One draw each, needed or not, so that a fault leaves the rest of the sequence as it was.
        let [lost, twice, held] = [(); 3].map(|()| self.rng.random::<f64>());
        let delay = self.rng.random_range(0..=delay_ms);
        let hold = self.rng.random_range(0..=hold_ms);
        if lost < loss {
            return;
        }
        let mut due = (now_ms + delay).max(self.earliest);
        if held < reordering {
            due += hold;
        } else {
            self.earliest = due;
        }
        let packet = Packet {
            basis_ms,
            bytes: frame.to_vec(),
        };
        if twice < duplication {
            self.under_way.push((due + hold, packet.clone()));
        }
        self.under_way.push((due, packet));
    }

    /// What has arrived by `now_ms` and was not yet taken, in the order of arrival.
    pub fn arrivals(&mut self, now_ms: u64) -> Vec<Packet> {
        // Stable: what arrives at the same time arrives in the order sent.
        self.under_way.sort_by_key(|(due, _)| *due);
        let count = self.under_way.partition_point(|(due, _)| *due <= now_ms);
        let arrived = self.under_way.drain(..count);
        arrived.map(|(_, packet)| packet).collect()
    }
}
