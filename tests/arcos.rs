//! Chapter `arcos`: the codec of the serial protocol, on vectors, on any bytes, and on the bytes of
//! real sessions.

mod common;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::Index;
use sidestep::arcos::{
    Argument, BaseParameters, BoundedReceiver, Configuration, EncodeError, Frame, FrameError,
    FrameWriter, HostCommand, Identity, MAX_FRAME, MAX_SONARS, NO_ECHO_RANGE, Odometry,
    P3DX_SONARS, PacketError, Receiver, SonarReading, SonarReadings, StandardInformation, Tail,
    checksum, command, compass_heading_deg, shortest_delta,
};
use sidestep_spec::arcos as law;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A SIP with a good checksum that a simulator sends after its sonars are switched on: it counts 16
/// readings and holds none.
const CLAIMS_SONARS: &str = "fa fb 26 32 00 00 00 00 00 00 00 00 00 00 82 00 00 00 00 1e 00 00 10 \
     00 00 00 ff ff 82 00 00 00 00 00 00 00 00 81 00 d2 13";

fn bytes(hex: &str) -> Vec<u8> {
    hex.split_ascii_whitespace()
        .map(|byte| u8::from_str_radix(byte, 16).expect("two hexadecimal digits"))
        .collect()
}

/// What encoding gives, as bytes of its own.
fn encoded(command: HostCommand<'_>) -> Vec<u8> {
    let mut buffer = [0; MAX_FRAME];
    let frame = command.encode(&mut buffer).expect("it fits");
    frame.as_bytes().to_vec()
}

fn any_bytes() -> impl Strategy<Value = Vec<u8>> {
    // Bytes that begin frames, or types of arguments, more often than by chance.
    let byte = prop_oneof![
        3 => any::<u8>(),
        1 => prop::sample::select(&[0xFA, 0xFB, 3, 4, 6, 0x3B, 0x1B, 0x2B, 0, 0xFF][..]),
    ];
    vec(byte, 0..300)
}

/// A frame with any number and arguments.
fn any_frame() -> impl Strategy<Value = Vec<u8>> {
    let arguments = prop_oneof![
        vec(any::<u8>(), 0..6),
        vec(any::<u8>(), 0..=246),
        (
            prop::sample::select(&[0x3B_u8, 0x1B, 0x2B][..]),
            // Zeros too: there is a negative one.
            vec(prop_oneof![Just(0), any::<u8>()], 0..4)
        )
            .prop_map(|(kind, rest)| [vec![kind], rest].concat()),
        vec(any::<u8>(), 0..60).prop_map(|text| {
            let length = u8::try_from(text.len()).expect("short");
            [vec![0x2B, length], text].concat()
        }),
    ];
    (any::<u8>(), arguments).prop_map(|(number, arguments)| {
        let mut buffer = [0; MAX_FRAME];
        let frame = FrameWriter::new(&mut buffer, number)
            .bytes(&arguments)
            .finish();
        frame.expect("it fits").as_bytes().to_vec()
    })
}

fn any_sonars() -> impl Strategy<Value = SonarReadings> {
    vec((0_u8..32, any::<u16>()), 0..=MAX_SONARS).prop_map(|readings| {
        let mut sonars = SonarReadings::new();
        for (index, range) in readings {
            assert!(sonars.push(SonarReading { index, range }));
        }
        sonars
    })
}

fn any_information() -> impl Strategy<Value = StandardInformation> {
    (
        (
            0x30_u8..=0x34,
            any::<(u16, u16, i16)>(),
            any::<(i16, i16)>(),
        ),
        any::<(u8, u16, i16, u16, u8)>(),
        any_sonars(),
        prop::option::of(any::<(u16, i16)>()),
    )
        .prop_map(
            |((kind, (x, y, heading), (left, right)), rest, sonars, tail)| StandardInformation {
                kind,
                x,
                y,
                heading,
                left_velocity: left,
                right_velocity: right,
                battery_decivolts: rest.0,
                stalls_and_bumpers: rest.1,
                control: rest.2,
                flags: rest.3,
                compass: rest.4,
                sonars,
                tail: tail.map_or(Tail::default(), |(battery, rate)| {
                    Tail::standard(battery, rate)
                }),
            },
        )
}

/// Places and lengths of the frames delivered, and where the bytes held begin, of a stream handed
/// over in pieces of the given sizes.
fn deliver<const LONGEST: usize>(
    receiver: &mut BoundedReceiver<LONGEST>,
    stream: &[u8],
    pieces: &[usize],
) -> (Vec<(usize, usize)>, usize) {
    let mut delivered = Vec::new();
    let mut done = 0;
    let mut rest = stream;
    let mut pieces = pieces.iter().copied().cycle();
    while !rest.is_empty() {
        let (mut piece, later) = rest.split_at(pieces.next().unwrap_or(1).clamp(1, rest.len()));
        while let Some(frame) = receiver.next_frame(&mut piece) {
            let length = frame.as_bytes().len();
            let place = done + usize::try_from(receiver.reception().skipped_bytes).expect("few");
            delivered.push((place, length));
            done += length;
        }
        assert!(piece.is_empty());
        rest = later;
    }
    let skipped = usize::try_from(receiver.reception().skipped_bytes).expect("few");
    (delivered, done + skipped)
}

proptest! {
    #![proptest_config(common::cases(4_000))]

    //= arcos.INV-1
    //= arcos.INV-2
    #[test]
    fn any_bytes_are_checked(data in any_bytes()) {
        let result = Frame::new_checked(&data);
        prop_assert_eq!(result.is_ok(), law::begins_with_frame(&data));
        if let Ok(frame) = result {
            prop_assert!(law::is_frame(frame.as_bytes()));
            prop_assert!(law::is_view(&data, frame.as_bytes(), frame.arguments()));
        }
    }

    //= arcos.INV-1
    #[test]
    fn a_frame_that_is_damaged_is_refused(
        frame in any_frame(), place in any::<Index>(), bit in 0_u8..8, tail in any_bytes()
    ) {
        prop_assert_eq!(
            Frame::new_checked(&[&frame[..], &tail[..]].concat()).map(|f| f.as_bytes().len()),
            Ok(frame.len())
        );
        for length in 0..frame.len() {
            prop_assert_eq!(Frame::new_checked(&frame[..length]), Err(FrameError::Truncated));
        }
        // A sum notices any single bit; that another count happens to fit, it does not.
        let mut damaged = frame.clone();
        let place = place.index(frame.len());
        damaged[place] ^= 1 << bit;
        prop_assert!(place == 2 || Frame::new_checked(&damaged).is_err());
        prop_assert_eq!(Frame::new_checked(&damaged).is_ok(), law::begins_with_frame(&damaged));
    }

    //= arcos.INV-3
    #[test]
    fn what_is_written_is_accepted(number in any::<u8>(), arguments in vec(any::<u8>(), 0..260)) {
        prop_assert_eq!(checksum(&arguments), law::checksum(&arguments));
        let mut buffer = [0; MAX_FRAME];
        match FrameWriter::new(&mut buffer, number).bytes(&arguments).finish() {
            Ok(frame) => {
                prop_assert!(law::is_frame_of(frame.as_bytes(), number, &arguments));
                prop_assert_eq!(frame.number(), number);
                prop_assert_eq!(frame.arguments(), &arguments[..]);
            }
            Err(error) => {
                prop_assert_eq!(error, EncodeError::TooLong);
                prop_assert!(arguments.len() > 246);
            }
        }
    }

    //= arcos.INV-2
    //= arcos.INV-4
    //= arcos.INV-5
    #[test]
    fn nothing_is_lost(
        parts in vec(prop_oneof![any_frame(), any_bytes()], 0..8),
        damage in any::<Option<(Index, u8)>>(),
        pieces in vec(1_usize..200, 1..5),
    ) {
        let mut stream = parts.concat();
        if let Some((place, with)) = damage
            && !stream.is_empty()
        {
            let place = place.index(stream.len());
            stream[place] = with;
        }
        let mut receiver = Receiver::new();
        let (delivered, held) = deliver(&mut receiver, &stream, &pieces);
        prop_assert!(law::nothing_is_lost(&stream, &delivered, held));
        let inside = delivered.iter().map(|frame| frame.1).sum();
        prop_assert!(law::all_bytes_are_accounted_for(
            stream.len(), inside, held - inside, stream.len() - held
        ));
        prop_assert_eq!(receiver.reception().frames, delivered.len() as u64);
        receiver.clear();
        prop_assert_eq!(receiver.reception().skipped_bytes, (stream.len() - inside) as u64);
    }

    /// What is longer than a receiver takes is no frame to it, and what is not is.
    //= arcos.INV-4
    #[test]
    fn a_receiver_of_short_frames_finds_them(
        frames in vec(any_frame(), 0..6), pieces in vec(1_usize..40, 1..5)
    ) {
        let mut receiver = BoundedReceiver::<20>::new();
        let (delivered, held) = deliver(&mut receiver, &frames.concat(), &pieces);
        prop_assert!(held + 20 > frames.concat().len());
        let mut place = 0;
        let mut all_fit = true;
        for frame in &frames {
            all_fit &= frame.len() <= 20;
            // Before the first that does not fit, nothing can be mistaken for anything else.
            prop_assert!(!all_fit || delivered.contains(&(place, frame.len())));
            place += frame.len();
        }
    }

    //= arcos.INV-6
    #[test]
    fn host_frames_are_encoded_again(frame in any_frame()) {
        let frame = Frame::new_checked(&frame).expect("a frame");
        let again = encoded(HostCommand::decode(frame));
        prop_assert!(law::is_unchanged(frame.as_bytes(), &again));
    }

    //= arcos.INV-7
    #[test]
    fn integers_come_back(
        value in prop_oneof![-70_000..70_000_i32, any::<i32>()], number in any::<u8>()
    ) {
        let command = HostCommand::with_integer(number, value);
        let mut buffer = [0; MAX_FRAME];
        let frame = command.encode(&mut buffer);
        prop_assert_eq!(frame.is_ok(), law::is_integer_encodable(value));
        match frame {
            Ok(frame) => {
                let arguments = <[u8; 3]>::try_from(frame.arguments()).expect("three bytes");
                prop_assert!(law::is_integer_argument(value, arguments));
                if matches!(number, command::VEL2 | command::DIGOUT) {
                    prop_assert_eq!(&encoded(HostCommand::decode(frame))[..], frame.as_bytes());
                } else {
                    prop_assert_eq!(HostCommand::decode(frame), command);
                }
            }
            Err(error) => prop_assert_eq!(error, EncodeError::Integer(value)),
        }
    }

    //= arcos.INV-2
    //= arcos.INV-8
    //= arcos.INV-9
    #[test]
    fn any_packet_is_judged(
        kind in 0x2E_u8..0x37, start in vec(any::<u8>(), 0..19), claimed in 0_u8..40,
        rest in vec(prop_oneof![0_u8..32, any::<u8>()], 0..120)
    ) {
        let mut arguments = start;
        if arguments.len() == 18 {
            arguments.push(claimed);
            arguments.extend(&rest);
        }
        let mut buffer = [0; MAX_FRAME];
        let frame = FrameWriter::new(&mut buffer, kind).bytes(&arguments).finish().expect("it fits");
        let result = StandardInformation::decode(frame);
        prop_assert_eq!(result.is_ok(), law::is_information(kind, &arguments));
        if arguments.len() >= 19 && claimed > 32 && StandardInformation::is_kind(kind) {
            prop_assert_eq!(result, Err(PacketError::TooManySonars(claimed)));
        }
        // The other packets only have to end in a value or an error.
        let _ = Identity::decode(frame);
        let _ = Configuration::decode(frame);
    }

    //= arcos.INV-9
    #[test]
    fn a_sip_that_lost_bytes_of_its_readings_is_refused(
        mut information in any_information(), lost in 1_usize..50
    ) {
        information.tail = Tail::default();
        let readings = information.sonars.as_slice().len();
        prop_assume!(readings > 0);
        let mut buffer = [0; MAX_FRAME];
        let frame = information.encode(&mut buffer).expect("it fits");
        let left = frame.arguments().len() - lost.min(3 * readings);
        let mut shorter = [0; MAX_FRAME];
        let shorter = FrameWriter::new(&mut shorter, frame.number())
            .bytes(&frame.arguments()[..left])
            .finish()
            .expect("it fits");
        prop_assert_eq!(
            StandardInformation::decode(shorter),
            Err(PacketError::SonarsMissing { claimed: readings as u8, bytes: left - 19 })
        );
    }

    //= arcos.INV-10
    #[test]
    fn sips_come_back(information in any_information()) {
        let mut buffer = [0; MAX_FRAME];
        let frame = information.encode(&mut buffer).expect("it fits");
        let again = StandardInformation::decode(frame);
        prop_assert_eq!(again, Ok(information));
        prop_assert!(law::holds_words(frame.arguments(), [
            information.x,
            information.y,
            information.heading.cast_unsigned(),
            information.left_velocity.cast_unsigned(),
            information.right_velocity.cast_unsigned(),
            information.control.cast_unsigned(),
            information.flags,
        ]));
    }

    //= arcos.INV-11
    //= arcos.INV-12
    #[test]
    fn odometry_is_unwrapped(
        origin in any::<(u16, u16)>(),
        steps in vec((-16_384_i16..16_384, -16_384_i16..16_384), 1..100),
        wrap in prop::sample::select(&[0x7FFF_u16, 0xFFFF][..]),
    ) {
        let mut odometry = Odometry::new();
        let (mut x, mut y) = origin;
        odometry.update(x & wrap, y & wrap);
        let mut expected = (0, 0);
        for (dx, dy) in steps {
            let last = (x, y);
            x = x.wrapping_add_signed(dx);
            y = y.wrapping_add_signed(dy);
            prop_assert!(law::is_shortest_delta(last.0, x, shortest_delta(last.0, x)));
            let before = odometry.units();
            odometry.update(x & wrap, y & wrap);
            let after = odometry.units();
            prop_assert!(law::is_one_step(before.0, after.0));
            prop_assert!(law::is_one_step(before.1, after.1));
            expected = (expected.0 + i64::from(dx), expected.1 + i64::from(dy));
            prop_assert_eq!(after, expected);
        }
        odometry.rebase();
        odometry.update(0, 0);
        prop_assert_eq!(odometry.units(), expected);
    }

    //= arcos.INV-14
    #[test]
    fn strings_come_back(
        name in vec(any::<u8>(), 0..30), class in vec(1_u8.., 0..30), subclass in vec(1_u8.., 1..30)
    ) {
        let identity = Identity { name: &name, class: &class, subclass: &subclass };
        let mut buffer = [0; MAX_FRAME];
        let frame = identity.encode(&mut buffer).expect("it fits");
        let again = Identity::decode(frame).expect("an identity");
        prop_assert!(law::is_text(again.name) && name.starts_with(again.name));
        prop_assert_eq!(again.class, &class[..]);
        prop_assert_eq!(again.subclass, &subclass[..]);
    }

    //= arcos.INV-2
    //= arcos.INV-14
    #[test]
    fn any_strings_are_bounded(arguments in vec(prop_oneof![1 => Just(0), 3 => any::<u8>()], 0..246)) {
        let mut buffer = [0; MAX_FRAME];
        for number in [command::SYNC2, Configuration::NUMBER] {
            let frame = FrameWriter::new(&mut buffer, number).bytes(&arguments).finish();
            let frame = frame.expect("it fits");
            if let Ok(identity) = Identity::decode(frame) {
                prop_assert!(law::is_text(identity.name));
                prop_assert!(law::is_text(identity.class));
                prop_assert!(law::is_text(identity.subclass));
            }
            if let Ok(configuration) = Configuration::decode(frame) {
                prop_assert!(law::is_text(configuration.name));
                prop_assert!(configuration.firmware.is_none_or(law::is_text));
            }
        }
    }
}

/// A tail may end at any field, as that of older firmware does: what is there is read, and comes back.
//= arcos.INV-10
#[test]
fn a_tail_may_end_at_any_byte() {
    let mut buffer = [0; MAX_FRAME];
    let information = StandardInformation {
        kind: StandardInformation::MOTORS_MOVING,
        ..StandardInformation::default()
    };
    let compulsory = information.encode(&mut buffer).expect("it fits");
    let compulsory = compulsory.arguments().len();
    let information = StandardInformation {
        tail: Tail::standard(124, -35),
        ..information
    };
    let whole = information.encode(&mut buffer).expect("it fits");
    let whole = whole.arguments().to_vec();
    let mut fields = std::collections::BTreeSet::new();
    for end in compulsory..=whole.len() {
        let (mut cut, mut again) = ([0; MAX_FRAME], [0; MAX_FRAME]);
        let frame = FrameWriter::new(&mut cut, information.kind)
            .bytes(&whole[..end])
            .finish()
            .expect("it fits");
        let read = StandardInformation::decode(frame).expect("a SIP");
        let frame = read.encode(&mut again).expect("it fits");
        assert!((compulsory..=end).contains(&frame.arguments().len()));
        assert_eq!(StandardInformation::decode(frame), Ok(read));
        fields.insert(frame.arguments().len());
    }
    assert_eq!(fields.len(), 13, "twelve fields, and none");
}

/// Every command number has a name of its own or none, and the commands have their numbers.
#[test]
fn commands_have_names_and_numbers() {
    let named = |number| command::name(number).map(|name| (number, name));
    let names: Vec<(u8, &str)> = (0..=u8::MAX).filter_map(named).collect();
    assert_eq!(
        names,
        [
            (0, "PULSE"),
            (1, "OPEN"),
            (2, "CLOSE"),
            (3, "POLLING"),
            (4, "ENABLE"),
            (5, "SETA"),
            (6, "SETV"),
            (7, "SETO"),
            (8, "MOVE"),
            (9, "ROTATE"),
            (10, "SETRV"),
            (11, "VEL"),
            (12, "HEAD"),
            (13, "DHEAD"),
            (15, "SAY"),
            (18, "CONFIG"),
            (19, "ENCODER"),
            (21, "RVEL"),
            (23, "SETRA"),
            (28, "SONAR"),
            (29, "STOP"),
            (30, "DIGOUT"),
            (32, "VEL2"),
            (35, "ADSEL"),
            (40, "IOREQUEST"),
            (44, "BUMPSTALL"),
            (48, "SONARCYCLE"),
            (50, "HOSTBAUD"),
            (55, "E_STOP"),
            (58, "GYRO"),
            (62, "BATTERYINFO"),
            (224, "SIM_SET_POSE"),
            (225, "SIM_RESET"),
            (236, "SIM_CTRL"),
            (237, "SIM_STAT"),
            (238, "SIM_MESSAGE"),
            (239, "SIM_EXIT"),
        ]
    );
    assert_eq!(HostCommand::zero_odometry().number, command::SETO);
    assert_eq!(HostCommand::request_configuration().number, command::CONFIG);
    let codes = [9_600, 19_200, 38_400, 57_600, 115_200]
        .map(|baud| HostCommand::host_baud(baud).map(|host| host.argument));
    assert_eq!(
        codes,
        [0, 1, 2, 3, 4].map(|code| Some(Argument::Integer(code)))
    );
    assert_eq!(HostCommand::host_baud(12_345), None);
}

/// What is refused is named with its numbers.
#[test]
fn errors_name_what_is_wrong() {
    let carried = FrameError::Checksum {
        computed: 0x12,
        carried: 0x34,
    };
    for (text, numbers) in [
        (FrameError::Count(250).to_string(), ["250", "249"]),
        (carried.to_string(), ["0012", "0034"]),
        (FrameError::Header.to_string(), ["FA", "FB"]),
        (FrameError::Truncated.to_string(), ["frame", "truncated"]),
        (PacketError::Type(0x90).to_string(), ["0x90", "type"]),
        (PacketError::Truncated.to_string(), ["packet", "ends"]),
        (PacketError::TooManySonars(33).to_string(), ["33", "sonar"]),
        (PacketError::SonarIndex(32).to_string(), ["32", "sonar"]),
        (
            PacketError::SonarsMissing {
                claimed: 16,
                bytes: 9,
            }
            .to_string(),
            ["16", "9"],
        ),
    ] {
        assert!(numbers.iter().all(|number| text.contains(number)), "{text}");
    }
}

/// All 256 bytes.
//= arcos.INV-13 (every input)
#[test]
fn compass_bytes_mean_what_both_conventions_say() {
    for byte in 0..=u8::MAX {
        assert!(
            law::is_compass_heading(byte, compass_heading_deg(byte)),
            "{byte}"
        );
    }
    assert_eq!([0, 181, 255].map(compass_heading_deg), [None; 3]);
}

/// Frames seen on the wire.
#[test]
fn commands_are_as_seen_on_the_wire() {
    let seen = [
        (HostCommand::pulse(), "fa fb 03 00 00 00"),
        (HostCommand::plain(command::SYNC1), "fa fb 03 01 00 01"),
        (HostCommand::close(), "fa fb 03 02 00 02"),
        (HostCommand::open(), "fa fb 06 01 3b 01 00 02 3b"),
        (
            HostCommand::enable_motors(true),
            "fa fb 06 04 3b 01 00 05 3b",
        ),
        (
            HostCommand::enable_sonars(true),
            "fa fb 06 1c 3b 01 00 1d 3b",
        ),
        (HostCommand::velocity(250), "fa fb 06 0b 3b fa 00 05 3b"),
        (HostCommand::velocity(-100), "fa fb 06 0b 1b 64 00 6f 1b"),
        (HostCommand::rotation(-10), "fa fb 06 15 1b 0a 00 1f 1b"),
        (HostCommand::heading(90), "fa fb 06 0c 3b 5a 00 66 3b"),
        (HostCommand::stop(), "fa fb 03 1d 00 1d"),
        (HostCommand::emergency_stop(), "fa fb 03 37 00 37"),
        (
            HostCommand::wheel_velocities(10, 5),
            "fa fb 06 20 3b 05 0a 25 45",
        ),
        (HostCommand::acceleration(300), "fa fb 06 05 3b 2c 01 31 3c"),
        (HostCommand::deceleration(300), "fa fb 06 05 1b 2c 01 31 1c"),
        (
            HostCommand::maximum_velocity(3000),
            "fa fb 06 06 3b b8 0b be 46",
        ),
        (
            HostCommand::maximum_rotation(150),
            "fa fb 06 0a 3b 96 00 a0 3b",
        ),
        (
            HostCommand::rotational_acceleration(100),
            "fa fb 06 17 3b 64 00 7b 3b",
        ),
        (
            HostCommand::rotational_deceleration(100),
            "fa fb 06 17 1b 64 00 7b 1b",
        ),
        (HostCommand::zero_odometry(), "fa fb 03 07 00 07"),
        (
            HostCommand {
                number: command::SETO,
                argument: Argument::Unvalued(0x3B),
            },
            "fa fb 04 07 3b 07 3b",
        ),
    ];
    for (command, hex) in seen {
        let expected = bytes(hex);
        assert_eq!(encoded(command), expected, "{hex}");
        assert_eq!(
            HostCommand::decode(Frame::new_checked(&expected).expect(hex)),
            command,
            "{hex}"
        );
    }
    assert_eq!(
        HostCommand::host_baud(38_400).and_then(|command| command.integer()),
        Some(2)
    );
    assert_eq!(HostCommand::host_baud(31_250), None);
    assert_eq!(command::name(command::VEL), Some("VEL"));
}

#[test]
fn identities_are_as_seen_on_the_wire() {
    for (hex, subclass, parameters) in [
        (
            "fa fb 18 02 41 4d 52 49 53 69 6d 00 50 69 6f 6e 65 65 72 00 70 33 64 78 00 eb bd",
            "p3dx",
            BaseParameters::P3DX,
        ),
        (
            "fa fb 1b 02 41 4d 52 49 53 69 6d 00 50 69 6f 6e 65 65 72 00 70 33 64 78 2d 73 68 00 \
             5f 52",
            "p3dx-sh",
            BaseParameters::P3DX_SH,
        ),
    ] {
        let frame = bytes(hex);
        let identity = Identity::decode(Frame::new_checked(&frame).expect(hex)).expect(hex);
        assert_eq!(identity.name, b"AMRISim");
        assert_eq!(identity.class, b"Pioneer");
        assert_eq!(identity.subclass, subclass.as_bytes());
        assert_eq!(
            BaseParameters::for_subclass(identity.subclass),
            Some(parameters)
        );
        let mut buffer = [0; MAX_FRAME];
        assert_eq!(
            identity.encode(&mut buffer).expect("it fits").as_bytes(),
            frame
        );
    }
    assert_eq!(BaseParameters::for_subclass(b"p3at"), None);
}

#[test]
fn a_configuration_is_as_seen_on_the_wire() {
    let frame = bytes(
        "fa fb 79 20 50 69 6f 6e 65 65 72 00 70 33 64 78 00 53 49 4d 00 00 0f 27 0f 27 0f 27 0f 27 \
         90 01 41 4d 52 49 53 69 6d 00 64 00 00 00 00 01 00 01 00 00 00 00 d0 07 00 00 00 00 00 00 \
         00 00 00 96 00 b8 0b 64 00 64 00 00 00 00 00 00 00 2c 01 2c 01 00 00 00 00 00 00 00 00 00 \
         00 02 00 00 00 00 00 00 00 00 00 53 2e 30 00 00 00 00 00 00 0f 27 0f 27 00 00 00 00 00 00 \
         00 00 93 5f",
    );
    let seen = Configuration {
        class: b"Pioneer",
        subclass: b"p3dx",
        serial: b"SIM",
        rotational_velocity_top: 9999,
        translational_velocity_top: 9999,
        rotational_acceleration_top: 9999,
        translational_acceleration_top: 9999,
        name: b"AMRISim",
        sip_cycle_ms: 100,
        host_baud: 0,
        front_sonars: true,
        rear_sonars: true,
        low_battery_decivolts: 0,
        watchdog_ms: 2000,
        rotational_velocity_max: 150,
        translational_velocity_max: 3000,
        rotational_acceleration: 100,
        rotational_deceleration: 100,
        translational_acceleration: 300,
        translational_deceleration: 300,
        sonar_cycle_ms: 0,
        autobaud: Some(Configuration::SWITCHABLE_BAUD),
        firmware: Some(b"S.0"),
    };
    assert_eq!(
        Configuration::decode(Frame::new_checked(&frame).expect("good")),
        Ok(seen)
    );
    let mut buffer = [0; MAX_FRAME];
    let own = seen.encode(&mut buffer).expect("it fits");
    assert_eq!(Configuration::decode(own), Ok(seen));

    // Cut anywhere, it is refused or lacks what older firmware lacks.
    for length in 0..own.arguments().len() {
        let mut buffer = [0; MAX_FRAME];
        let cut = FrameWriter::new(&mut buffer, Configuration::NUMBER)
            .bytes(&own.arguments()[..length])
            .finish()
            .expect("it fits");
        match Configuration::decode(cut) {
            Ok(older) => assert_eq!(older.watchdog_ms, 2000),
            Err(error) => assert_eq!(error, PacketError::Truncated),
        }
    }
}

//= arcos.INV-9
#[test]
fn the_sip_that_claims_sonars_is_refused() {
    let frame = bytes(CLAIMS_SONARS);
    let frame = Frame::new_checked(&frame).expect("its checksum is good");
    let error = StandardInformation::decode(frame).expect_err("its readings are missing");
    assert_eq!(
        error,
        PacketError::SonarsMissing {
            claimed: 16,
            bytes: 16
        }
    );
    assert_eq!(
        error.to_string(),
        "packet claims 16 sonar readings in 16 bytes"
    );
}

#[test]
fn a_sip_is_as_seen_on_the_wire() {
    let frame = bytes(
        "fa fb 56 32 00 00 00 00 00 00 00 00 00 00 82 00 00 00 00 1f 00 00 10 00 39 06 01 9c 0d 02 \
         f0 0a 03 4d 07 04 88 13 05 63 12 06 de 11 07 4e 04 08 c1 03 09 46 03 0a 68 03 0b 27 02 0c \
         16 02 0d df 03 0e c0 03 0f 53 05 00 00 00 ff ff 82 00 00 00 00 00 00 00 00 81 00 88 18",
    );
    let frame = Frame::new_checked(&frame).expect("good");
    let information = StandardInformation::decode(frame).expect("good");
    assert!(information.motors_enabled() && information.sonars_enabled() && !information.e_stop());
    assert!(!information.left_stalled() && !information.right_stalled());
    assert_eq!(information.battery_decivolts, 130);
    let sonars = information.sonars.as_slice();
    assert_eq!(sonars.len(), 16);
    assert_eq!(
        sonars[0],
        SonarReading {
            index: 0,
            range: 1593
        }
    );
    assert_eq!(
        sonars[4],
        SonarReading {
            index: 4,
            range: NO_ECHO_RANGE
        }
    );
    assert_eq!(information.tail.battery_decivolts, Some(130));
    assert_eq!(information.tail.temperature, Some(-127));
    let mut buffer = [0; MAX_FRAME];
    let own = information.encode(&mut buffer).expect("it fits");
    assert_eq!(own.as_bytes(), frame.as_bytes());
}

#[test]
fn stalls_and_bumpers_are_told_apart() {
    let information = StandardInformation {
        stalls_and_bumpers: u16::from_le_bytes([0b0000_0101, 0b1000_0000]),
        ..StandardInformation::default()
    };
    assert!(information.left_stalled() && !information.right_stalled());
    assert_eq!(
        (information.rear_bumpers(), information.front_bumpers()),
        (0b10, 0b100_0000)
    );
}

/// Each flag is one bit, and the types under which the packet is sent are five.
#[test]
fn flags_and_kinds_are_told_apart() {
    let flags = |flags| {
        let information = StandardInformation {
            flags,
            ..StandardInformation::default()
        };
        [
            information.motors_enabled(),
            information.sonars_enabled(),
            information.e_stop(),
        ]
    };
    assert_eq!(flags(0), [false; 3]);
    assert_eq!(
        flags(StandardInformation::FLAG_MOTORS),
        [true, false, false]
    );
    assert_eq!(
        flags(StandardInformation::FLAG_SONARS),
        [false, true, false]
    );
    assert_eq!(
        flags(StandardInformation::FLAG_E_STOP),
        [false, false, true]
    );
    let kinds: Vec<u8> = (0..=u8::MAX)
        .filter(|kind| StandardInformation::is_kind(*kind))
        .collect();
    assert_eq!(kinds, [0x30, 0x31, 0x32, 0x33, 0x34]);
}

#[test]
fn a_base_reports_in_its_own_units() {
    let (older, newer) = (BaseParameters::P3DX, BaseParameters::P3DX_SH);
    let mut odometry = Odometry::new();
    odometry.update(0xFFFF, 0);
    odometry.update(999, 0x7F9C);
    assert_eq!(odometry.units(), (1000, -100));
    assert_eq!(odometry.position_mm(&older), (485.0, -48.5));
    assert_eq!(odometry.position_mm(&newer), (1000.0, -100.0));
    assert!((older.heading_rad(-1024) + std::f32::consts::FRAC_PI_2).abs() < 1e-6);
    // A turn of 25 degrees a second to the right at 200 mm/s, as a simulator reported it.
    let (speed, rate) = older.twist(277, 122);
    assert!((speed - 199.5).abs() < 1e-3 && (rate.to_degrees() + 24.9).abs() < 0.1);
    let coarse = BaseParameters {
        velocity_mm_s: 2.0,
        range_mm: 0.5,
        ..older
    };
    assert_eq!(
        coarse.twist(100, 50),
        (150.0, -50.0 * older.differential_rad_mm)
    );
    assert_eq!(coarse.range_mm(1_001), 500.5);
    // The ring is symmetric.
    for (left, right) in [
        (0, 7),
        (1, 6),
        (2, 5),
        (3, 4),
        (15, 8),
        (14, 9),
        (13, 10),
        (12, 11),
    ] {
        let (left, right) = (P3DX_SONARS[left], P3DX_SONARS[right]);
        assert_eq!((left.x_mm, left.y_mm), (right.x_mm, -right.y_mm));
        assert_eq!(left.heading_deg, -right.heading_deg);
    }
}

/// A trace, one line that begins with `>` (host to robot) or `<` (robot to host) before each piece
/// of bytes, the bytes themselves in hexadecimal on the next: what `socat -x` writes.
fn read_trace(path: &Path) -> [Vec<Vec<u8>>; 2] {
    let text = std::fs::read_to_string(path).expect("a trace is text");
    let mut directions = [Vec::new(), Vec::new()];
    let mut direction = 0;
    for line in text.lines() {
        match line.as_bytes().first() {
            Some(b'>') => direction = 0,
            Some(b'<') => direction = 1,
            Some(_) => directions[direction].push(bytes(line)),
            None => {}
        }
    }
    directions
}

/// Every frame of real sessions, in both directions.
//= arcos.INV-6
//= arcos.INV-9
#[test]
fn real_sessions_are_read_in_full() {
    let Some(folder) = std::env::var_os("SIDESTEP_TRACES") else {
        eprintln!(
            "\n*** SKIPPED: no traces of real sessions. Set SIDESTEP_TRACES to their folder. ***\n\
             *** Only the vectors in tests/arcos.rs were read.                              ***\n"
        );
        return;
    };
    let mut paths: Vec<PathBuf> = std::fs::read_dir(&folder)
        .expect("SIDESTEP_TRACES is a folder")
        .map(|entry| entry.expect("an entry").path())
        .collect();
    paths.sort();
    assert!(!paths.is_empty(), "{folder:?} is empty");
    let mut refused = 0;
    for path in paths {
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let [host, robot] = read_trace(&path);

        let mut receiver = Receiver::new();
        let mut again = Vec::new();
        for mut piece in host.iter().map(Vec::as_slice) {
            while let Some(frame) = receiver.next_frame(&mut piece) {
                again.extend(encoded(HostCommand::decode(frame)));
            }
        }
        assert_eq!(
            again,
            host.concat(),
            "{name}: host frames are encoded again"
        );
        let from_host = receiver.reception();

        let mut receiver = Receiver::new();
        let mut seen: BTreeMap<&str, u32> = BTreeMap::new();
        for mut piece in robot.iter().map(Vec::as_slice) {
            while let Some(frame) = receiver.next_frame(&mut piece) {
                let kind = match frame.number() {
                    command::SYNC0 | command::SYNC1 => "echoes",
                    command::SYNC2 => {
                        Identity::decode(frame).expect("an identity");
                        "identities"
                    }
                    Configuration::NUMBER => {
                        let stored = Configuration::decode(frame).expect("a configuration");
                        assert_eq!(stored.watchdog_ms, 2000);
                        "configurations"
                    }
                    kind if StandardInformation::is_kind(kind) => {
                        match StandardInformation::decode(frame) {
                            Ok(information) => {
                                let mut buffer = [0; MAX_FRAME];
                                let own = information.encode(&mut buffer).expect("it fits");
                                assert_eq!(own.as_bytes(), frame.as_bytes());
                                "SIPs"
                            }
                            Err(error) => {
                                let missing = PacketError::SonarsMissing {
                                    claimed: 16,
                                    bytes: 16,
                                };
                                assert_eq!(error, missing);
                                refused += 1;
                                "SIPs refused"
                            }
                        }
                    }
                    _ => "others",
                };
                *seen.entry(kind).or_default() += 1;
            }
        }
        let from_robot = receiver.reception();
        println!("{name}: {} host frames, {seen:?}", from_host.frames);
        for reception in [from_host, from_robot] {
            assert_eq!(
                (reception.bad_checksums, reception.skipped_bytes),
                (0, 0),
                "{name}"
            );
            assert!(reception.frames > 0, "{name}");
        }
    }
    println!("{refused} SIPs refused for claiming sonar readings that they do not hold");
}

/// What cannot be encoded is named, with the number and what is allowed.
#[test]
fn errors_name_what_was_wrong() {
    let integer = EncodeError::Integer(70_000).to_string();
    assert!(
        integer.contains("70000 outside -65535..=65535"),
        "{integer}"
    );
    let long = EncodeError::TooLong.to_string();
    assert!(long.contains(&MAX_FRAME.to_string()), "{long}");
}

/// Beeps are a string of durations and tones.
#[test]
fn beeps_are_a_string() {
    let beep = HostCommand::say(&[25, 60]);
    assert_eq!(
        (beep.number, beep.argument),
        (15, Argument::Text(&[25, 60]))
    );
}
