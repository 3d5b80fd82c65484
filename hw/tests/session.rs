//! The session against a small scripted robot, in virtual time.

use sidestep::arcos::{
    BaseParameters, Configuration, Frame, HostCommand, Identity, MAX_FRAME, PacketError, Receiver,
    SonarReading, StandardInformation, Tail, command,
};
use sidestep_hw::session::{Event, Hindrance, LinkLoss, Output, Rejection, Session, Settings};

/// The SIP a simulator sends after its sonars are switched on: 16 readings claimed, none present.
const CLAIMS_SONARS: [u8; 41] = [
    0xfa, 0xfb, 0x26, 0x32, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x82, 0x00,
    0x00, 0x00, 0x00, 0x1e, 0x00, 0x00, 0x10, 0x00, 0x00, 0x00, 0xff, 0xff, 0x82, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x81, 0x00, 0xd2, 0x13,
];

/// The robot's end, as far as these tests need it.
#[derive(Default)]
struct Peer {
    receiver: Receiver,
    /// The rate of its port; `None` for a connection without one.
    baud: Option<u32>,
    /// What it calls itself.
    subclass: &'static str,
    /// Whether `HOSTBAUD` is offered, and whether it is obeyed.
    offers_baud: bool,
    obeys_baud: bool,
    /// How many `CLOSE` commands of an open session it misses.
    deaf_to_close: u32,
    /// Whether it has lost power.
    dead: bool,
    /// Where the greeting stands; 3 is open.
    synced: u8,
    motors: bool,
    sonars: bool,
    e_stop: bool,
    x: u16,
    /// Sent in place of the next SIPs.
    instead: Option<Vec<u8>>,
    next_sip: u64,
    /// What was heard, in order.
    heard: Vec<(u64, u8, Option<i32>)>,
}

impl Peer {
    const OPEN: u8 = 3;

    fn hear(&mut self, mut bytes: &[u8], now: u64) -> Vec<u8> {
        let mut answer = Vec::new();
        let mut receiver = std::mem::take(&mut self.receiver);
        while let Some(frame) = receiver.next_frame(&mut bytes) {
            let command = HostCommand::decode(frame);
            self.heard.push((now, command.number, command.integer()));
            self.obey(command, frame, &mut answer, now);
        }
        self.receiver = receiver;
        answer
    }

    fn obey(&mut self, command: HostCommand<'_>, frame: Frame<'_>, answer: &mut Vec<u8>, now: u64) {
        let on = command.integer() == Some(1);
        match (self.synced, command.number) {
            (Self::OPEN, command::CLOSE) if self.deaf_to_close > 0 => self.deaf_to_close -= 1,
            (Self::OPEN, command::CLOSE) => {
                self.synced = 0;
                self.motors = false;
            }
            (Self::OPEN, command::ENABLE) => self.motors = on && !self.e_stop,
            (Self::OPEN, command::SONAR) => self.sonars = on,
            (Self::OPEN, command::SETO) => self.x = 0,
            (Self::OPEN, command::CONFIG) => answer.extend(self.configuration()),
            (Self::OPEN, command::HOSTBAUD) => {
                // What was on its way is no sign of the new rate.
                answer.extend(self.sip());
                if self.obeys_baud {
                    self.baud = Some(38_400);
                }
            }
            (Self::OPEN, _) => {}
            (2, command::OPEN) => {
                self.synced = Self::OPEN;
                self.next_sip = now + 50;
            }
            (_, command::SYNC0) => {
                self.synced = 1;
                answer.extend_from_slice(frame.as_bytes());
            }
            (1, command::SYNC1) => {
                self.synced = 2;
                answer.extend_from_slice(frame.as_bytes());
            }
            (2, command::SYNC2) => {
                let identity = Identity {
                    name: b"Scripted",
                    class: b"Pioneer",
                    subclass: self.subclass.as_bytes(),
                };
                answer.extend_from_slice(identity.encode(&mut [0; MAX_FRAME]).unwrap().as_bytes());
            }
            _ => {}
        }
    }

    fn configuration(&self) -> Vec<u8> {
        let configuration = Configuration {
            class: b"Pioneer",
            subclass: self.subclass.as_bytes(),
            serial: b"1",
            rotational_velocity_top: 360,
            translational_velocity_top: 1500,
            rotational_acceleration_top: 300,
            translational_acceleration_top: 2000,
            name: b"Scripted",
            sip_cycle_ms: 100,
            host_baud: 0,
            front_sonars: true,
            rear_sonars: true,
            low_battery_decivolts: 110,
            watchdog_ms: 2000,
            rotational_velocity_max: 100,
            translational_velocity_max: 750,
            rotational_acceleration: 100,
            rotational_deceleration: 100,
            translational_acceleration: 300,
            translational_deceleration: 300,
            sonar_cycle_ms: 40,
            autobaud: Some(if self.offers_baud { 2 } else { 0 }),
            firmware: Some(b"1.0"),
        };
        configuration
            .encode(&mut [0; MAX_FRAME])
            .unwrap()
            .as_bytes()
            .to_vec()
    }

    fn speak(&mut self, now: u64) -> Vec<u8> {
        if self.synced != Self::OPEN || now < self.next_sip {
            return Vec::new();
        }
        self.next_sip = now + 100;
        if let Some(bytes) = &self.instead {
            return bytes.clone();
        }
        self.sip()
    }

    fn sip(&self) -> Vec<u8> {
        let mut information = StandardInformation {
            kind: StandardInformation::MOTORS_STOPPED,
            x: self.x,
            battery_decivolts: 125,
            flags: u16::from(self.motors)
                | if self.sonars {
                    StandardInformation::FLAG_SONARS
                } else {
                    0
                }
                | if self.e_stop {
                    StandardInformation::FLAG_E_STOP
                } else {
                    0
                },
            tail: Tail::standard(125, 0),
            ..StandardInformation::default()
        };
        information.sonars.push(SonarReading {
            index: 3,
            range: 1234,
        });
        information
            .encode(&mut [0; MAX_FRAME])
            .unwrap()
            .as_bytes()
            .to_vec()
    }

    fn count(&self, number: u8) -> usize {
        self.heard.iter().filter(|heard| heard.1 == number).count()
    }
}

/// A session, a robot, the line between them and a control loop that ticks every 100 ms.
struct Rig {
    session: Session,
    peer: Peer,
    baud: u32,
    now: u64,
    /// What the control loop asks for; `None` while it hangs.
    wish: Option<(i32, i32)>,
    events: Vec<Event>,
}

impl Rig {
    fn new(settings: Settings, peer: Peer) -> Self {
        let now = 1000;
        let session = Session::new(settings, now);
        Self {
            session,
            peer,
            baud: 9600,
            now,
            wish: Some((200, -10)),
            events: Vec::new(),
        }
    }

    /// Over a connection without a baud rate.
    fn over_tcp() -> Self {
        let settings = Settings {
            bauds: Vec::new(),
            ..Settings::default()
        };
        Self::new(
            settings,
            Peer {
                subclass: "p3dx",
                ..Peer::default()
            },
        )
    }

    fn over_serial(baud: u32) -> Self {
        let peer = Peer {
            subclass: "p3dx-sh",
            baud: Some(baud),
            ..Peer::default()
        };
        Self::new(Settings::default(), peer)
    }

    /// What arrives of `bytes` at the other end.
    fn line(&self, bytes: &[u8]) -> Vec<u8> {
        if self.peer.dead {
            Vec::new()
        } else if self.peer.baud.is_some_and(|baud| baud != self.baud) {
            bytes
                .iter()
                .map(|byte| byte.rotate_left(3) ^ 0xA5)
                .collect()
        } else {
            bytes.to_vec()
        }
    }

    fn run(&mut self, ms: u64) -> Vec<Event> {
        self.events.clear();
        for now in (self.now..self.now + ms).step_by(10) {
            self.now = now + 10;
            let said = self.peer.speak(now);
            let said = self.line(&said);
            self.session.receive(&said, now);
            if now % 100 == 0
                && let Some((speed, turn)) = self.wish
            {
                self.session.command(speed, turn, now);
            }
            while let Some(output) = self.session.poll(now) {
                match output {
                    Output::Send(bytes) => {
                        let bytes = self.line(&bytes);
                        let answer = self.peer.hear(&bytes, now);
                        let answer = self.line(&answer);
                        self.session.receive(&answer, now);
                    }
                    Output::SetBaud(baud) => self.baud = baud,
                    Output::Discard => {}
                }
            }
            while let Some(event) = self.session.next_event() {
                self.events.push(event);
            }
        }
        std::mem::take(&mut self.events)
    }

    /// Runs until the robot is ready.
    fn ready(&mut self) -> Vec<Event> {
        let mut events = Vec::new();
        for _ in 0..300 {
            events.extend(self.run(100));
            if self.session.is_ready() {
                return events;
            }
        }
        panic!("not ready: {events:?}");
    }
}

fn lost(events: &[Event]) -> Option<&LinkLoss> {
    events.iter().find_map(|event| match event {
        Event::LinkLost(reason) => Some(reason),
        _ => None,
    })
}

fn is_motion(number: u8) -> bool {
    matches!(number, command::VEL | command::RVEL)
}

#[test]
fn a_robot_is_greeted_opened_and_made_ready() {
    let mut rig = Rig::over_tcp();
    rig.peer.x = 500;
    let events = rig.ready();
    assert!(matches!(
        &events[0],
        Event::Connected { robot, parameters }
            if robot.subclass == "p3dx" && *parameters == BaseParameters::P3DX
    ));
    assert!(matches!(&events[1], Event::Configured(stored) if stored.watchdog_ms == 2000));
    assert!(events.contains(&Event::Ready { resumed: false }));
    let numbers: Vec<u8> = rig.peer.heard.iter().map(|heard| heard.1).collect();
    assert_eq!(
        numbers
            .iter()
            .copied()
            .filter(|number| *number != command::PULSE)
            .collect::<Vec<_>>()[..13],
        [
            command::SYNC1,
            command::SYNC2,
            command::OPEN,
            command::CONFIG,
            command::SETA,
            command::SETA,
            command::SETRA,
            command::SETRA,
            command::SETV,
            command::SETRV,
            command::SETO,
            command::SONAR,
            command::ENABLE,
        ]
    );
    rig.run(1000);
    assert_eq!(rig.peer.count(command::VEL), rig.peer.count(command::RVEL));
    let last = rig.peer.heard.len() - 2;
    assert_eq!(rig.peer.heard[last].1, command::VEL);
    assert_eq!(rig.peer.heard[last].2, Some(200));
    assert_eq!(rig.peer.heard[last + 1].2, Some(-10));
}

// Session rule 1.
#[test]
fn no_motion_is_commanded_before_the_robot_is_ready() {
    let mut rig = Rig::over_tcp();
    rig.peer.e_stop = true;
    let events = rig.run(5000);
    assert!(events.contains(&Event::Waiting(Hindrance::EmergencyStop)));
    assert!(!rig.peer.heard.iter().any(|heard| is_motion(heard.1)));
    rig.peer.e_stop = false;
    rig.ready();
    rig.run(200);
    assert!(rig.peer.count(command::VEL) > 0);
}

#[test]
fn the_baud_rates_are_tried_in_turn() {
    let mut rig = Rig::over_serial(57_600);
    let events = rig.ready();
    assert_eq!(rig.session.baud(), Some(57_600));
    assert_eq!(rig.session.parameters(), Some(&BaseParameters::P3DX_SH));
    assert_eq!(lost(&events), None);
}

#[test]
fn a_better_baud_rate_is_taken_where_the_robot_allows_it() {
    let mut rig = Rig::over_serial(9600);
    rig.peer.offers_baud = true;
    rig.peer.obeys_baud = true;
    let events = rig.ready();
    assert_eq!(
        (rig.session.baud(), rig.peer.baud),
        (Some(38_400), Some(38_400))
    );
    assert!(
        !events
            .iter()
            .any(|event| matches!(event, Event::BaudKept { .. }))
    );
}

#[test]
fn a_robot_that_does_not_follow_a_change_of_baud_rate_is_followed() {
    let mut rig = Rig::over_serial(9600);
    rig.peer.offers_baud = true;
    let events = rig.ready();
    assert!(events.contains(&Event::BaudKept {
        asked: 38_400,
        kept: 9600
    }));
    assert_eq!(rig.session.baud(), Some(9600));

    rig.peer.dead = true;
    rig.run(1000);
    rig.peer.dead = false;
    rig.ready();
    assert_eq!(
        rig.peer.count(command::HOSTBAUD),
        1,
        "it is not asked again"
    );
}

#[test]
fn a_robot_that_is_already_open_is_closed_first() {
    let mut rig = Rig::over_serial(19_200);
    rig.peer.synced = Peer::OPEN;
    let events = rig.ready();
    assert!(events.contains(&Event::AlreadyOpen));
}

#[test]
fn nobody_there_is_said_and_said_again() {
    let mut rig = Rig::over_serial(9600);
    rig.peer.dead = true;
    let events = rig.run(20_000);
    let expected = LinkLoss::NoAnswer {
        bauds: Settings::default().bauds,
    };
    let said = events
        .iter()
        .filter(|event| **event == Event::LinkLost(expected.clone()))
        .count();
    assert_eq!(said, 2);
    rig.peer.dead = false;
    rig.ready();
}

#[test]
fn units_are_never_guessed() {
    let mut rig = Rig::over_tcp();
    rig.peer.subclass = "p3at";
    let events = rig.run(500);
    assert_eq!(
        lost(&events),
        Some(&LinkLoss::UnknownSubclass("p3at".to_owned()))
    );
    assert_eq!(
        rig.peer.count(command::OPEN),
        1,
        "only SYNC1 has this number"
    );
}

// Session rule 3.
#[test]
fn a_lost_link_stops_the_robot_and_is_mended() {
    let mut rig = Rig::over_tcp();
    rig.ready();
    rig.peer.dead = true;
    let silent_from = rig.now;
    let events = rig.run(600);
    assert!(matches!(lost(&events), Some(LinkLoss::Silence { ms }) if (500..=600).contains(ms)));
    assert!(!rig.session.is_ready());

    rig.peer.dead = false;
    let events = rig.ready();
    assert!(events.contains(&Event::Ready { resumed: true }));
    assert_eq!(rig.peer.count(command::SETO), 1, "the position is kept");
    assert!(
        rig.peer
            .heard
            .iter()
            .all(|heard| heard.0 < silent_from || heard.0 > silent_from + 600)
    );
}

#[test]
fn a_robot_that_is_heard_no_more_but_may_still_hear_is_told_to_stop() {
    let mut rig = Rig::over_tcp();
    rig.ready();
    rig.peer.instead = Some(Vec::new());
    rig.run(600);
    let [.., stop, close] = &rig.peer.heard[..] else {
        panic!()
    };
    assert_eq!((stop.1, close.1), (command::E_STOP, command::CLOSE));
    assert!(!rig.peer.motors);
}

// Session rule 2.
#[test]
fn a_control_loop_that_hangs_feeds_nothing_to_the_watchdog() {
    let mut rig = Rig::over_tcp();
    rig.ready();
    rig.run(1000);
    rig.wish = None;
    let before = rig.peer.heard.len();
    let events = rig.run(5000);
    assert_eq!(rig.peer.heard.len(), before);
    assert!(rig.session.is_ready());
    assert_eq!(lost(&events), None);
}

// Session rule 3.
#[test]
fn a_command_given_before_the_link_was_lost_is_not_sent_after() {
    let mut rig = Rig::over_tcp();
    rig.ready();
    rig.session.command(300, 0, rig.now);
    let later = rig.now + 10_000;
    let mut sent = Vec::new();
    while let Some(output) = rig.session.poll(later) {
        if let Output::Send(bytes) = output {
            sent.extend(bytes);
        }
    }
    let mut peer = Peer::default();
    peer.hear(&sent, later);
    assert_eq!(
        peer.heard,
        [
            (later, command::E_STOP, None),
            (later, command::CLOSE, None)
        ]
    );
}

#[test]
fn speeds_beyond_the_settings_are_cut() {
    let mut rig = Rig::over_tcp();
    rig.ready();
    rig.wish = Some((i32::MAX, i32::MIN));
    rig.run(200);
    let [.., speed, turn] = &rig.peer.heard[..] else {
        panic!()
    };
    assert_eq!((speed.2, turn.2), (Some(400), Some(-60)));
}

#[test]
fn a_bad_checksum_is_reported_and_survived() {
    let mut rig = Rig::over_tcp();
    rig.ready();
    let mut bad = rig.peer.sip();
    bad[10] ^= 0x04;
    rig.peer.instead = Some(bad);
    let events = rig.run(100);
    assert!(events.iter().any(|event| matches!(
        event,
        Event::Rejected(Rejection::Noise {
            bad_checksums: 1,
            ..
        })
    )));
    rig.peer.instead = None;
    rig.run(300);
    assert!(rig.session.is_ready());
    assert_eq!(rig.session.reception().bad_checksums, 1);
}

//= arcos.INV-9
// Session rule 3.
#[test]
fn a_malformed_sip_is_reported_and_keeps_no_link_alive() {
    let mut rig = Rig::over_tcp();
    rig.ready();
    rig.peer.instead = Some(CLAIMS_SONARS.to_vec());
    let events = rig.run(700);
    let error = PacketError::SonarsMissing {
        claimed: 16,
        bytes: 16,
    };
    assert!(events.contains(&Event::Rejected(Rejection::Packet {
        frame: CLAIMS_SONARS.to_vec(),
        error
    })));
    assert!(matches!(lost(&events), Some(LinkLoss::Silence { .. })));
}

#[test]
fn a_robot_that_was_disabled_stays_so_until_it_is_enabled() {
    let mut rig = Rig::over_tcp();
    rig.ready();
    rig.peer.e_stop = true;
    rig.peer.motors = false;
    let events = rig.run(300);
    assert!(events.contains(&Event::Disabled(Hindrance::EmergencyStop)));
    rig.peer.e_stop = false;
    let before = rig.peer.heard.len();
    rig.run(2000);
    let heard = &rig.peer.heard[before..];
    assert!(heard.len() >= 19, "the loop lives, and the watchdog is fed");
    assert!(heard.iter().all(|heard| heard.1 == command::PULSE));
    rig.session.enable(rig.now);
    let events = rig.ready();
    assert!(events.contains(&Event::Ready { resumed: true }));
}

#[test]
fn a_transport_that_failed_is_taken_up_again() {
    let mut rig = Rig::over_tcp();
    rig.ready();
    rig.session.command(300, 0, rig.now);
    rig.session.transport_lost("the port vanished");
    rig.peer.synced = 0;
    let events = rig.run(1000);
    assert_eq!(
        lost(&events),
        Some(&LinkLoss::Transport("the port vanished".to_owned()))
    );
    let before = rig.peer.heard.len();
    rig.run(5000);
    assert_eq!(rig.peer.heard.len(), before);
    rig.session.transport_restored(rig.now);
    rig.ready();
}

#[test]
fn closing_is_repeated_until_the_stream_ends() {
    let mut rig = Rig::over_tcp();
    rig.ready();
    rig.peer.deaf_to_close = 2;
    rig.session.close(rig.now);
    let events = rig.run(2000);
    assert_eq!(events.last(), Some(&Event::Closed));
    assert!(rig.session.is_closed());
    assert_eq!(rig.peer.synced, 0);
    assert_eq!(rig.peer.count(command::STOP), 1);
    // One CLOSE has the number of SYNC2.
    assert_eq!(rig.peer.count(command::CLOSE), 1 + 3);
}

#[test]
fn a_session_closed_while_greeting_sends_no_close() {
    let mut rig = Rig::over_tcp();
    rig.peer.dead = true;
    rig.run(700);
    rig.peer.dead = false;
    rig.session.close(rig.now);
    assert_eq!(rig.run(1000), [Event::Closed]);
    assert!(rig.peer.heard.is_empty());
}

/// Any bytes at any time: no panic, and no motion unless the robot is ready.
// Session rule 1.
#[test]
fn no_input_brings_a_session_to_move_a_robot_that_is_not_ready() {
    let mut state = 1_u64;
    let mut random = move |below: u64| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let peer = Peer {
        subclass: "p3dx",
        ..Peer::default()
    };
    let mut said = vec![peer.sip(), peer.configuration(), CLAIMS_SONARS.to_vec()];
    let ready = Peer {
        motors: true,
        sonars: true,
        ..Peer::default()
    };
    said.push(ready.sip());
    for number in 0..3 {
        let frame = HostCommand::plain(number);
        said.push(
            frame
                .encode(&mut [0; MAX_FRAME])
                .unwrap()
                .as_bytes()
                .to_vec(),
        );
    }
    let identity = Identity {
        name: b"",
        class: b"",
        subclass: b"p3dx",
    };
    said.push(
        identity
            .encode(&mut [0; MAX_FRAME])
            .unwrap()
            .as_bytes()
            .to_vec(),
    );

    let mut reached = 0;
    for _ in 0..200 {
        let mut session = Session::new(Settings::default(), 0);
        let mut now = 0;
        for _ in 0..500 {
            now += random(120);
            let mut bytes = said[usize::try_from(random(said.len() as u64)).unwrap()].clone();
            if random(10) == 0 {
                let at = usize::try_from(random(bytes.len() as u64)).unwrap();
                bytes[at] ^= 1 << random(8);
            }
            session.receive(&bytes, now);
            match random(40) {
                0 => session.stop(now),
                1 => session.emergency_stop(now),
                2 => session.enable(now),
                3 if random(20) == 0 => session.close(now),
                4 if random(20) == 0 => session.transport_lost("gone"),
                5 => session.transport_restored(now),
                _ => {}
            }
            while session.poll(now).is_some() {}
            session.command(100, 10, now);
            let mut peer = Peer::default();
            while let Some(output) = session.poll(now) {
                if let Output::Send(bytes) = output {
                    peer.hear(&bytes, now);
                }
            }
            let moves = peer.heard.iter().any(|heard| is_motion(heard.1));
            assert_eq!(moves, session.is_ready());
            reached += u32::from(moves);
            while session.next_event().is_some() {}
        }
    }
    assert!(reached > 100, "{reached}");
}
