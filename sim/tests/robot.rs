//! The protocol as hosts meet it: the handshake, its quirks, commands, SIPs, the watchdog.

mod common;

use common::{drive_to, frame, frames, in_world, integer, open, plain, robot, sips};
use sidestep::arcos::{
    Configuration, Frame, HostCommand, Identity, NO_ECHO_RANGE, PacketError, StandardInformation,
    command,
};
use sidestep_sim::Simulation;
use sidestep_sim::World;
use sidestep_sim::geometry::Point;
use sidestep_sim::robot::{Firing, Parameters, Session};

/// Sends `bytes` and returns the answer.
fn ask(simulation: &mut Simulation, bytes: &[u8]) -> Vec<u8> {
    simulation.robot_mut().receive(bytes);
    simulation.robot_mut().transmit()
}

fn opened() -> Simulation {
    let mut simulation = robot(Parameters::default());
    open(&mut simulation);
    simulation
}

#[test]
fn a_session_opens_with_the_echoes_and_the_identity() {
    let mut simulation = robot(Parameters::default());
    assert_eq!(ask(&mut simulation, &plain(0)), plain(0));
    assert_eq!(ask(&mut simulation, &plain(1)), plain(1));
    let answer = ask(&mut simulation, &plain(2));
    let identity = Identity::decode(Frame::new_checked(&answer).unwrap()).unwrap();
    assert_eq!(identity.name, b"sidestep");
    assert_eq!(
        (identity.class, identity.subclass),
        (&b"Pioneer"[..], &b"p3dx-sh"[..])
    );
    // No SIP flows before OPEN, with or without its argument; then one comes every 100 ms.
    simulation.advance_to(500);
    assert_eq!(simulation.robot_mut().transmit(), []);
    assert_eq!(ask(&mut simulation, &frame(&HostCommand::open())), []);
    simulation.advance_to(590);
    assert_eq!(simulation.robot_mut().transmit(), []);
    simulation.advance_to(1500);
    let heard = sips(&simulation.robot_mut().transmit());
    assert_eq!(heard.len(), 10);
    // Motors and sonars wait to be switched on.
    assert!(
        heard
            .iter()
            .all(|sip| sip.flags == 0 && sip.sonars.as_slice().is_empty())
    );
}

#[test]
fn before_a_session_nothing_but_sync0_is_answered() {
    let mut simulation = robot(Parameters::default());
    for number in 1..=255 {
        assert_eq!(ask(&mut simulation, &plain(number)), [], "command {number}");
        assert_eq!(
            ask(&mut simulation, &integer(number, 1)),
            [],
            "command {number}"
        );
    }
    // What one host writes to wake a wireless modem.
    assert_eq!(ask(&mut simulation, b"WMS2\r"), []);
    simulation.advance_to(1000);
    assert_eq!(simulation.robot().session(), Session::Unsynchronised);
    assert_eq!(ask(&mut simulation, &plain(0)), plain(0));
}

#[test]
fn sync0_restarts_a_handshake_at_any_point() {
    for sent in 0..=3 {
        let mut simulation = robot(Parameters::default());
        for number in 0..sent {
            assert_ne!(ask(&mut simulation, &plain(number)), []);
        }
        assert_eq!(ask(&mut simulation, &plain(0)), plain(0));
        assert_eq!(ask(&mut simulation, &plain(1)), plain(1));
        assert_ne!(ask(&mut simulation, &plain(2)), []);
        ask(&mut simulation, &plain(1));
        assert_eq!(simulation.robot().session(), Session::Open);
    }
    // CLOSE ends one that was not opened yet.
    let mut simulation = robot(Parameters::default());
    for number in [0, 1, 2, command::CLOSE] {
        ask(&mut simulation, &plain(number));
    }
    assert_eq!(ask(&mut simulation, &plain(command::OPEN)), []);
    assert_eq!(simulation.robot().session(), Session::Unsynchronised);
    // Out of turn, the others are ignored.
    let mut simulation = robot(Parameters::default());
    ask(&mut simulation, &plain(0));
    assert_eq!(ask(&mut simulation, &plain(2)), []);
    assert_eq!(ask(&mut simulation, &plain(1)), plain(1));
}

#[test]
fn close_stops_the_robot_and_ends_the_session() {
    for close in [plain(command::CLOSE), frame(&HostCommand::close())] {
        let mut simulation = opened();
        ask(&mut simulation, &frame(&HostCommand::velocity(300)));
        drive_to(&mut simulation, 3000);
        assert!((simulation.robot().base().speed() - 0.3).abs() < 1e-9);
        let _ = simulation.robot_mut().transmit();
        assert_eq!(ask(&mut simulation, &close), []);
        assert_eq!(simulation.robot().session(), Session::Unsynchronised);
        assert!(!simulation.robot().motors_enabled());
        simulation.advance_to(6000);
        assert_eq!(simulation.robot().base().speed(), 0.0);
        assert_eq!(simulation.robot_mut().transmit(), []);
        // And it can be opened again, at a standstill.
        open(&mut simulation);
        simulation.advance_to(6100);
        let heard = sips(&simulation.robot_mut().transmit());
        assert_eq!(heard[0].kind, StandardInformation::MOTORS_STOPPED);
    }
}

#[test]
fn an_open_session_survives_the_port_being_closed() {
    let mut simulation = opened();
    let velocity = frame(&HostCommand::velocity(300));
    ask(&mut simulation, &velocity[..4]);
    simulation.advance_to(500);
    simulation.robot_mut().hang_up();
    assert_eq!(simulation.robot_mut().transmit(), []);
    ask(&mut simulation, &velocity[4..]);
    // A host that opens the port again meets a stream of SIPs, closes and starts over.
    simulation.advance_to(1000);
    assert_eq!(sips(&simulation.robot_mut().transmit()).len(), 5);
    assert_eq!(simulation.robot().base().travelled(), 0.0);
    assert_eq!(ask(&mut simulation, &plain(command::CLOSE)), []);
    assert_eq!(ask(&mut simulation, &plain(0)), plain(0));
}

#[test]
fn motors_are_disabled_until_enabled() {
    let mut simulation = robot(Parameters::default());
    for number in [0, 1, 2, 1] {
        ask(&mut simulation, &plain(number));
    }
    let velocity = frame(&HostCommand::velocity(300));
    ask(&mut simulation, &velocity);
    drive_to(&mut simulation, 1000);
    assert_eq!(simulation.robot().base().travelled(), 0.0);
    ask(&mut simulation, &frame(&HostCommand::enable_motors(true)));
    drive_to(&mut simulation, 2000);
    // Enabling does not bring back what was refused.
    assert_eq!(simulation.robot().base().travelled(), 0.0);
    ask(&mut simulation, &velocity);
    drive_to(&mut simulation, 4000);
    assert!(simulation.robot().base().speed() > 0.29);
    let last = *sips(&simulation.robot_mut().transmit()).last().unwrap();
    assert!(last.motors_enabled());
    assert_eq!(last.kind, StandardInformation::MOTORS_MOVING);
    ask(&mut simulation, &frame(&HostCommand::enable_motors(false)));
    drive_to(&mut simulation, 6000);
    assert_eq!(simulation.robot().base().speed(), 0.0);
}

#[test]
fn the_watchdog_stops_a_robot_after_two_seconds_of_silence_and_not_before() {
    let mut simulation = opened();
    ask(&mut simulation, &frame(&HostCommand::velocity(200)));
    drive_to(&mut simulation, 3000);
    let silent_since = simulation.now_ms() - 500;
    let delay = simulation.robot().base().parameters().delay_ms;
    simulation.advance_to(silent_since + 2000 + delay);
    assert_eq!(simulation.robot().base().speed(), 0.2);
    simulation.advance_to(silent_since + 2000 + delay + 10);
    assert!(simulation.robot().base().speed() < 0.2);
    assert!(simulation.robot().watchdog_tripped());
    // Garbage and bad checksums are not commands.
    simulation
        .robot_mut()
        .receive(&[0xFA, 0xFB, 3, 0, 0, 1, 0xFA]);
    assert!(simulation.robot().watchdog_tripped());
    simulation.advance_to(silent_since + 3000);
    assert_eq!(simulation.robot().base().speed(), 0.0);
    // A pulse ends the silence but does not bring the motion back; an order does.
    ask(&mut simulation, &plain(command::PULSE));
    assert!(!simulation.robot().watchdog_tripped());
    let resumed = simulation.now_ms() + 1000;
    drive_to(&mut simulation, resumed);
    assert_eq!(simulation.robot().base().speed(), 0.0);
    ask(&mut simulation, &frame(&HostCommand::velocity(200)));
    drive_to(&mut simulation, resumed + 2000);
    assert_eq!(simulation.robot().base().speed(), 0.2);
}

#[test]
fn commands_feed_the_watchdog_for_as_long_as_they_come() {
    for watchdog_ms in [500, 2000, 5000] {
        let mut simulation = robot(Parameters {
            watchdog_ms,
            ..Parameters::default()
        });
        open(&mut simulation);
        ask(&mut simulation, &frame(&HostCommand::velocity(100)));
        for _ in 0..20 {
            let next = simulation.now_ms() + u64::from(watchdog_ms) - 10;
            simulation.advance_to(next);
            // An unknown command is a valid one as well.
            ask(&mut simulation, &integer(200, 5));
        }
        assert_eq!(simulation.robot().base().speed(), 0.1, "{watchdog_ms} ms");
    }
}

#[test]
fn damaged_frames_have_no_effect() {
    let velocity = frame(&HostCommand::velocity(300));
    for bit in 0..velocity.len() * 8 {
        let mut simulation = opened();
        let mut damaged = velocity.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        ask(&mut simulation, &damaged);
        // Whatever the damage began is over before this arrives.
        ask(&mut simulation, &[0; 300]);
        simulation.advance_to(1000);
        assert_eq!(simulation.robot().base().travelled(), 0.0, "bit {bit}");
        ask(&mut simulation, &velocity);
        simulation.advance_to(2000);
        assert!(
            simulation.robot().base().travelled() > 0.0,
            "deaf after bit {bit}"
        );
    }
    // A count of 0 kills a simulator in wide use.
    let mut simulation = opened();
    ask(&mut simulation, &[0xFA, 0xFB, 0, 0, 0, 0]);
    ask(&mut simulation, &velocity);
    simulation.advance_to(1000);
    assert!(simulation.robot().base().speed() > 0.0);
}

#[test]
fn noise_on_the_line_is_survived() {
    use rand::{Rng, RngExt, SeedableRng};
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(2);
    let mut simulation = opened();
    for _ in 0..2000 {
        let mut bytes = [0; 64];
        rng.fill_bytes(&mut bytes);
        // Headers are rare in noise.
        let at = rng.random_range(0..60);
        bytes[at..at + 2].copy_from_slice(&[0xFA, 0xFB]);
        ask(&mut simulation, &bytes);
        let next = simulation.now_ms() + 10;
        simulation.advance_to(next);
    }
    // Every command number with every form of argument, of any size.
    for number in 0..=255 {
        for argument in [
            vec![],
            vec![0x3B],
            vec![0x3B, 0xFF, 0xFF],
            vec![0x1B, 0, 0],
            vec![0x1B, 0xFF, 0xFF],
            vec![0x2B, 3, b'a', b'b', b'c'],
            vec![0x2B, 200],
            vec![0xAA; 40],
        ] {
            let mut buffer = [0; sidestep::arcos::MAX_FRAME];
            let frame = sidestep::arcos::FrameWriter::new(&mut buffer, number)
                .bytes(&argument)
                .finish()
                .unwrap();
            open(&mut simulation);
            ask(&mut simulation, frame.as_bytes());
            let next = simulation.now_ms() + 100;
            simulation.advance_to(next);
            let base = simulation.robot().base();
            assert!(base.speed().abs() <= base.parameters().top.speed);
            assert!(base.pose().position.x.is_finite());
        }
    }
}

#[test]
fn velocities_appear_at_the_wheels() {
    let mut simulation = opened();
    ask(&mut simulation, &frame(&HostCommand::velocity(200)));
    ask(&mut simulation, &frame(&HostCommand::rotation(-25)));
    drive_to(&mut simulation, 3000);
    let sip = *sips(&simulation.robot_mut().transmit()).last().unwrap();
    // As observed of another simulator: 277 and 122 mm/s, within a millimetre per second.
    assert!(
        (sip.left_velocity - 278).abs() <= 1,
        "{}",
        sip.left_velocity
    );
    assert!(
        (sip.right_velocity - 122).abs() <= 1,
        "{}",
        sip.right_velocity
    );
    assert_eq!(sip.tail.rotational_velocity, Some(-250));

    let mut simulation = opened();
    ask(
        &mut simulation,
        &frame(&HostCommand::wheel_velocities(10, 5)),
    );
    drive_to(&mut simulation, 3000);
    let sip = *sips(&simulation.robot_mut().transmit()).last().unwrap();
    assert_eq!((sip.left_velocity, sip.right_velocity), (200, 100));

    // Backwards, braked by STOP.
    let mut simulation = opened();
    ask(&mut simulation, &frame(&HostCommand::velocity(-100)));
    drive_to(&mut simulation, 2000);
    assert_eq!(simulation.robot().base().speed(), -0.1);
    ask(&mut simulation, &frame(&HostCommand::stop()));
    drive_to(&mut simulation, 3000);
    assert_eq!(simulation.robot().base().speed(), 0.0);
    assert!(simulation.robot().motors_enabled());
}

#[test]
fn limits_are_set_within_what_the_robot_can_do() {
    let mut simulation = opened();
    for command in [
        HostCommand::maximum_velocity(400),
        HostCommand::acceleration(200),
        HostCommand::deceleration(1000),
        HostCommand::maximum_rotation(30),
    ] {
        ask(&mut simulation, &frame(&command));
    }
    ask(&mut simulation, &frame(&HostCommand::velocity(900)));
    ask(&mut simulation, &frame(&HostCommand::rotation(-90)));
    simulation.advance_to(1050);
    assert!((simulation.robot().base().speed() - 0.2).abs() < 1e-9);
    drive_to(&mut simulation, 4000);
    assert_eq!(simulation.robot().base().speed(), 0.4);
    assert!((simulation.robot().base().turn_rate() + 30_f64.to_radians()).abs() < 1e-9);
    let way = simulation.robot().base().travelled();
    ask(&mut simulation, &frame(&HostCommand::stop()));
    drive_to(&mut simulation, 6000);
    let braking = simulation.robot().base().travelled() - way;
    assert!(
        (braking - 0.4 * 0.05 - 0.4 * 0.4 / 2.0).abs() < 1e-9,
        "{braking}"
    );
    // Beyond the top nothing can be set, and a limit of 0 is none.
    ask(
        &mut simulation,
        &frame(&HostCommand::maximum_velocity(60_000)),
    );
    ask(&mut simulation, &integer(command::SETA, 0));
    assert_eq!(simulation.robot().base().limits().speed, 1.5);
    assert_eq!(simulation.robot().base().limits().deceleration, 1.0);
}

#[test]
fn headings_and_distances_are_reached() {
    let mut simulation = opened();
    ask(&mut simulation, &frame(&HostCommand::heading(90)));
    drive_to(&mut simulation, 5000);
    ask(&mut simulation, &integer(command::MOVE, 500));
    drive_to(&mut simulation, 10_000);
    ask(&mut simulation, &integer(command::DHEAD, -120));
    drive_to(&mut simulation, 15_000);
    let sip = *sips(&simulation.robot_mut().transmit()).last().unwrap();
    assert_eq!((sip.x, sip.y), (0, 500));
    assert_eq!(sip.heading, (-30_f64 / 360.0 * 4096.0).round() as i16);
    assert_eq!(sip.control, sip.heading);
    // SETO, even in the form of a host that sends a type byte without a value.
    ask(&mut simulation, &[0xFA, 0xFB, 4, 7, 0x3B, 7, 0x3B]);
    drive_to(&mut simulation, 15_100);
    let sip = *sips(&simulation.robot_mut().transmit()).last().unwrap();
    assert_eq!((sip.x, sip.y, sip.heading), (0, 0, 0));
}

#[test]
fn positions_wrap_at_16_bits_in_the_units_of_the_robot() {
    let mut simulation = robot(Parameters {
        units: sidestep::arcos::BaseParameters::P3DX,
        ..Parameters::default()
    });
    open(&mut simulation);
    ask(&mut simulation, &frame(&HostCommand::velocity(-1000)));
    let mut odometry = sidestep::arcos::Odometry::new();
    let units = simulation.robot().parameters().units;
    // 50 m are three times round the 15 bits of some hosts.
    while simulation.now_ms() < 52_000 {
        ask(&mut simulation, &plain(0));
        let next = simulation.now_ms() + 100;
        simulation.advance_to(next);
        for sip in sips(&simulation.robot_mut().transmit()) {
            odometry.update(sip.x, sip.y);
        }
    }
    let (x, y) = odometry.position_mm(&units);
    let truth = simulation.robot().base().pose().position;
    assert!(truth.x < -50.0);
    assert!((f64::from(x) - truth.x * 1000.0).abs() < 1.0, "{x}");
    assert_eq!(y, 0.0);
}

#[test]
fn all_sonars_report_in_each_sip() {
    let mut world = World::new();
    world
        .add_wall(Point::new(1.166, -3.0), Point::new(1.166, 3.0))
        .unwrap();
    let mut parameters = Parameters::default();
    parameters.sonar.noise = 0.0;
    for count in [8, 16] {
        parameters.sonars = count;
        let mut simulation = in_world(world.clone(), parameters.clone());
        open(&mut simulation);
        simulation.advance_to(1000);
        for sip in sips(&simulation.robot_mut().transmit()) {
            let readings = sip.sonars.as_slice();
            assert!(readings.iter().map(|r| usize::from(r.index)).eq(0..count));
            assert_eq!((readings[3].range, readings[4].range), (1000, 1000));
            assert_eq!(readings[0].range, NO_ECHO_RANGE);
            assert_eq!(
                sip.flags >> 1 & 0b1111,
                if count == 16 { 0b11 } else { 0b1 }
            );
        }
        ask(&mut simulation, &frame(&HostCommand::enable_sonars(false)));
        simulation.advance_to(1100);
        let sip = sips(&simulation.robot_mut().transmit())[0];
        assert!(sip.sonars.as_slice().is_empty() && !sip.sonars_enabled());
        // Only the second array: bit 0 switches on, 2 in the bits above selects.
        ask(&mut simulation, &integer(command::SONAR, 0b101));
        simulation.advance_to(1200);
        let sip = sips(&simulation.robot_mut().transmit())[0];
        let readings = sip.sonars.as_slice();
        assert!(
            readings
                .iter()
                .map(|r| usize::from(r.index))
                .eq(8..count.max(8))
        );
    }
}

#[test]
fn arrays_fire_one_sonar_after_the_other() {
    let mut simulation = robot(Parameters {
        firing: Firing::RoundRobin { ping_ms: 40 },
        ..Parameters::default()
    });
    open(&mut simulation);
    let mut heard = [0; 16];
    simulation.advance_to(3200);
    for sip in sips(&simulation.robot_mut().transmit()) {
        let count = sip.sonars.as_slice().len();
        assert!(count == 4 || count == 6, "{count}");
        for reading in sip.sonars.as_slice() {
            heard[usize::from(reading.index)] += 1;
        }
    }
    // 80 pings of each array are ten rounds.
    assert_eq!(heard, [10; 16]);
    ask(&mut simulation, &integer(command::SONARCYCLE, 20));
    simulation.advance_to(3600);
    let count = |sip: &StandardInformation| sip.sonars.as_slice().len();
    let counts: Vec<_> = sips(&simulation.robot_mut().transmit())
        .iter()
        .map(count)
        .collect();
    assert_eq!(counts, [10; 4]);
    // What was heard before CLOSE is not told in the next session.
    simulation.advance_to(3650);
    ask(&mut simulation, &plain(command::CLOSE));
    open(&mut simulation);
    simulation.advance_to(3750);
    assert_eq!(count(&sips(&simulation.robot_mut().transmit())[0]), 10);
}

#[test]
fn a_hollow_sip_claims_readings_that_it_does_not_hold() {
    let mut simulation = robot(Parameters {
        hollow_sip: true,
        ..Parameters::default()
    });
    open(&mut simulation);
    simulation.advance_to(200);
    let heard = frames(&simulation.robot_mut().transmit());
    assert_eq!(heard.len(), 2);
    let decoded = StandardInformation::decode(Frame::new_checked(&heard[0]).unwrap());
    assert!(
        matches!(decoded, Err(PacketError::SonarsMissing { claimed: 16, .. })),
        "{decoded:?}"
    );
    let decoded = StandardInformation::decode(Frame::new_checked(&heard[1]).unwrap());
    assert_eq!(decoded.unwrap().sonars.as_slice().len(), 16);
}

#[test]
fn the_configuration_tells_watchdog_and_limits() {
    let mut simulation = opened();
    let answer = ask(
        &mut simulation,
        &frame(&HostCommand::request_configuration()),
    );
    let configuration = Configuration::decode(Frame::new_checked(&answer).unwrap()).unwrap();
    assert_eq!(configuration.subclass, b"p3dx-sh");
    assert_eq!(configuration.watchdog_ms, 2000);
    assert_eq!(configuration.sip_cycle_ms, 100);
    assert_eq!(configuration.translational_velocity_top, 1500);
    assert_eq!(configuration.translational_deceleration, 300);
    assert_eq!(configuration.rotational_acceleration, 100);
    assert!(configuration.front_sonars && configuration.rear_sonars);
    assert_eq!(configuration.autobaud, Some(Configuration::SWITCHABLE_BAUD));
    assert_eq!(configuration.host_baud, 0);
}

#[test]
fn the_port_has_one_rate_at_a_time() {
    let mut simulation = robot(Parameters::default());
    // A host that begins at the wrong rate is not understood, and neither is the answer.
    let robot = simulation.robot_mut();
    for _ in 0..10 {
        robot.receive_at(38_400, &plain(0));
    }
    assert_eq!(robot.transmit(), []);
    robot.receive_at(9600, &plain(0));
    assert_ne!(robot.clone().transmit_at(38_400), plain(0));
    assert_eq!(robot.transmit_at(9600), plain(0));
    open(&mut simulation);
    ask(
        &mut simulation,
        &frame(&HostCommand::host_baud(38_400).unwrap()),
    );
    assert_eq!(simulation.robot().baud(), 38_400);
    simulation.advance_to(100);
    assert_eq!(sips(&simulation.robot_mut().transmit_at(38_400)).len(), 1);
    // There is no such rate.
    ask(&mut simulation, &integer(command::HOSTBAUD, 5));
    ask(&mut simulation, &integer(command::HOSTBAUD, -1));
    assert_eq!(simulation.robot().baud(), 38_400);
    ask(&mut simulation, &frame(&HostCommand::close()));
    assert_eq!(simulation.robot().baud(), 9600);
}

#[test]
fn emergency_stops_stop() {
    let mut simulation = opened();
    ask(&mut simulation, &frame(&HostCommand::velocity(1000)));
    drive_to(&mut simulation, 5000);
    let way = simulation.robot().base().travelled();
    ask(&mut simulation, &frame(&HostCommand::emergency_stop()));
    drive_to(&mut simulation, 7000);
    let braking = simulation.robot().base().travelled() - way;
    assert!(
        (braking - 0.05 - 1.0 / (2.0 * 2.0)).abs() < 1e-9,
        "{braking}"
    );
    // The button takes the motors away until it is released and they are enabled again.
    simulation.robot_mut().press_e_stop(true);
    ask(&mut simulation, &frame(&HostCommand::enable_motors(true)));
    ask(&mut simulation, &frame(&HostCommand::velocity(100)));
    drive_to(&mut simulation, 8000);
    let sip = *sips(&simulation.robot_mut().transmit()).last().unwrap();
    assert!(sip.e_stop() && !sip.motors_enabled() && sip.left_velocity == 0);
    simulation.robot_mut().press_e_stop(false);
    ask(&mut simulation, &frame(&HostCommand::enable_motors(true)));
    ask(&mut simulation, &frame(&HostCommand::velocity(100)));
    drive_to(&mut simulation, 10_000);
    assert_eq!(simulation.robot().base().speed(), 0.1);
}

#[test]
fn a_collision_shows_as_a_stall() {
    let mut world = World::new();
    world
        .add_wall(Point::new(1.0, -9.0), Point::new(1.0, 9.0))
        .unwrap();
    let mut simulation = in_world(world, Parameters::default());
    open(&mut simulation);
    ask(&mut simulation, &frame(&HostCommand::velocity(300)));
    drive_to(&mut simulation, 5000);
    let sip = *sips(&simulation.robot_mut().transmit()).last().unwrap();
    assert!(sip.left_stalled() && sip.right_stalled());
    assert_eq!(sip.left_velocity, 0);
    assert_eq!(simulation.outcome().contacts_while_driving.obstacles, 1);
    assert!(
        simulation
            .outcome()
            .minimum_clearance_while_driving
            .obstacles
            <= 0.0
    );
}

#[test]
fn a_host_that_never_reads_costs_bounded_memory() {
    let mut simulation = opened();
    drive_to(&mut simulation, 200_000);
    assert!(simulation.robot_mut().transmit().len() < 70_000);
}

#[test]
fn the_compass_reads_within_its_resolution() {
    use sidestep::arcos::compass_heading_deg;
    let mut parameters = Parameters::default();
    parameters.compass.as_mut().unwrap().noise = 0.0;
    let mut simulation = robot(parameters.clone());
    open(&mut simulation);
    for heading in [0, 1, 45, 90, 179, 270, 359] {
        ask(&mut simulation, &frame(&HostCommand::heading(heading)));
        let next = simulation.now_ms() + 5000;
        drive_to(&mut simulation, next);
        let sip = *sips(&simulation.robot_mut().transmit()).last().unwrap();
        let compass = i32::from(compass_heading_deg(sip.compass).unwrap());
        let error = (compass - heading + 180).rem_euclid(360) - 180;
        assert!(error.abs() <= 1, "{heading}° read as {compass}°");
    }
    parameters.compass = None;
    let mut simulation = robot(parameters);
    open(&mut simulation);
    simulation.advance_to(100);
    let sip = sips(&simulation.robot_mut().transmit())[0];
    assert_eq!(compass_heading_deg(sip.compass), None);
}

#[test]
fn what_cannot_be_is_refused() {
    use sidestep_sim::ArcosRobot;
    use sidestep_sim::geometry::Pose;
    let build = |change: fn(&mut Parameters)| {
        let mut parameters = Parameters::default();
        change(&mut parameters);
        ArcosRobot::new(parameters, Pose::new(0.0, 0.0, 0.0), 0).map(|_| ())
    };
    assert_eq!(build(|_| ()), Ok(()));
    let changes: [fn(&mut Parameters); 8] = [
        |p| p.sonars = 12,
        |p| p.watchdog_ms = 0,
        |p| p.sip_cycle_ms = 95,
        |p| p.host_baud = 4800,
        |p| p.firing = Firing::RoundRobin { ping_ms: 0 },
        |p| p.name = "x".repeat(300),
        |p| p.sonar.half_angle = 2.0,
        |p| p.compass.as_mut().unwrap().noise = -1.0,
    ];
    for change in changes {
        let error = build(change).unwrap_err().to_string();
        assert!(error.contains("allowed"), "{error}");
    }
}
