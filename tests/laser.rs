//! Chapter `laser`: the codec of the laser scanner's telegrams.

mod common;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use sidestep::laser::{
    Baud, FACTORY_PASSWORD, MAX_TELEGRAM, MeasuringMode, Missing, Reading, Receiver, Reply,
    ReplyError, Request, Scan, Severity, Status, Telegram, TelegramError, TelegramWriter, Unit,
    Variant, checksum,
};
use sidestep_spec::laser as law;

/// Whole telegrams that SICK's manuals print, as three programs by others carry them: requests with
/// the payload that each has.
const PRINTED: &[(Request, &[u8])] = &[
    (Request::State, &[2, 0, 1, 0, 0x31, 0x15, 0x12]),
    (Request::Type, &[2, 0, 1, 0, 0x3A, 0x1E, 0x12]),
    (Request::ReadConfiguration, &[2, 0, 1, 0, 0x74, 0x50, 0x12]),
    (Request::OneScan, &[2, 0, 2, 0, 0x30, 1, 0x31, 0x18]),
    (Request::Continuous, &[2, 0, 2, 0, 0x20, 0x24, 0x34, 8]),
    (Request::Monitor, &[2, 0, 2, 0, 0x20, 0x25, 0x35, 8]),
    (
        Request::Baud(Baud::B9600),
        &[2, 0, 2, 0, 0x20, 0x42, 0x52, 8],
    ),
    (
        Request::Baud(Baud::B19200),
        &[2, 0, 2, 0, 0x20, 0x41, 0x51, 8],
    ),
    (
        Request::Baud(Baud::B38400),
        &[2, 0, 2, 0, 0x20, 0x40, 0x50, 8],
    ),
    (
        Request::Baud(Baud::B500000),
        &[2, 0, 2, 0, 0x20, 0x48, 0x58, 8],
    ),
    (
        Request::Setup(FACTORY_PASSWORD),
        &[
            2, 0, 0x0A, 0, 0x20, 0, 0x53, 0x49, 0x43, 0x4B, 0x5F, 0x4C, 0x4D, 0x53, 0xBE, 0xC5,
        ],
    ),
    (
        Request::Variant(Variant::Degrees180Step1),
        &[2, 0, 5, 0, 0x3B, 0xB4, 0, 0x64, 0, 0x97, 0x49],
    ),
    (
        Request::Variant(Variant::Degrees180StepHalf),
        &[2, 0, 5, 0, 0x3B, 0xB4, 0, 0x32, 0, 0x3B, 0x1F],
    ),
    (
        Request::Variant(Variant::Degrees100StepQuarter),
        &[2, 0, 5, 0, 0x3B, 0x64, 0, 0x19, 0, 0xE7, 0x72],
    ),
    (
        Request::Variant(Variant::Degrees100Step1),
        &[2, 0, 5, 0, 0x3B, 0x64, 0, 0x64, 0, 0x1D, 0x0F],
    ),
];

//= laser.INV-1
//= laser.INV-3
#[test]
fn requests_are_as_printed() {
    for (request, printed) in PRINTED {
        let mut buffer = [0; MAX_TELEGRAM];
        let telegram = request.encode(&mut buffer, 0).expect("it fits");
        assert_eq!(telegram.as_bytes(), *printed, "{request:?}");
        assert!(law::is_telegram(printed));
        assert!(!telegram.is_from_scanner());
    }
}

/// The replies to a change of mode that the two manuals print, by scanners at addresses 0 and 1.
#[test]
fn replies_are_as_printed() {
    for (address, bytes) in [
        (0, [2, 0x80, 3, 0, 0xA0, 0, 0x10, 0x16, 0x0A]),
        (1, [2, 0x81, 3, 0, 0xA0, 0, 0x10, 0x36, 0x1A]),
    ] {
        let telegram = Telegram::new_checked(&bytes).expect("a telegram");
        assert_eq!(telegram.address(), address);
        let (reply, status) = Reply::decode(telegram).expect("a reply");
        assert_eq!(reply, Reply::Mode { accepted: true });
        assert_eq!(status.severity(), Severity::Fine);
        assert!(status.is_usable());
    }
}

fn reply(command: u8, data: &[u8]) -> Vec<u8> {
    let mut buffer = [0; MAX_TELEGRAM];
    let telegram = TelegramWriter::reply(&mut buffer, 0, command)
        .bytes(data)
        .u8(0x10)
        .finish();
    telegram.expect("it fits").as_bytes().to_vec()
}

/// What is not changed in a configuration goes back as it came.
#[test]
fn configuration_is_changed_where_asked() {
    for length in [32_u8, 34] {
        let data: Vec<u8> = (100..100 + length).collect();
        let bytes = reply(0xF4, &data);
        let telegram = Telegram::new_checked(&bytes).expect("a telegram");
        let Ok((Reply::Configuration(before), _)) = Reply::decode(telegram) else {
            panic!("no configuration");
        };
        assert_eq!(before.as_bytes(), data);
        assert_eq!(before.mode(), None);
        let after = before.with(MeasuringMode::FieldsAbc, Unit::Millimetre);
        assert_eq!(after.mode(), Some(MeasuringMode::FieldsAbc));
        let mut buffer = [0; MAX_TELEGRAM];
        let request = Request::Configure(after);
        let request = request.encode(&mut buffer, 3).expect("it fits");
        let mut expected = data.clone();
        (expected[5], expected[6]) = (2, 1);
        assert!(law::is_telegram_of(request.as_bytes(), 3, 0x77, &expected));
    }
    for length in [0, 31, 35, 200] {
        let bytes = reply(0xF4, &vec![0; length]);
        let telegram = Telegram::new_checked(&bytes).expect("a telegram");
        let refused = Reply::decode(telegram);
        assert_eq!(refused, Err(ReplyError::Size { bytes: length }));
    }
}

#[test]
fn replies_are_told_apart() {
    let decode = |bytes: &[u8]| {
        let telegram = Telegram::new_checked(bytes).expect("a telegram");
        format!("{:?}", Reply::decode(telegram).map(|(reply, _)| reply))
    };
    for (bytes, expected) in [
        (reply(0xA0, &[2]), "Ok(Mode { accepted: false })"),
        (reply(0xA0, &[]), "Err(Size { bytes: 0 })"),
        (
            reply(0xBB, &[1, 180, 0, 50, 0]),
            "Ok(Variant { accepted: true, field_of_view: 180, step: 50 })",
        ),
        (reply(0xBB, &[1, 180, 0, 50]), "Err(Size { bytes: 4 })"),
        (reply(0xF7, &[0]), "Ok(Configured { accepted: false })"),
        (reply(0x92, &[]), "Ok(Refused)"),
        (reply(0xB1, &[7]), "Ok(Other { command: 177, data: [7] })"),
    ] {
        assert_eq!(decode(&bytes), expected);
    }
    let mut buffer = [0; MAX_TELEGRAM];
    let request = Request::State.encode(&mut buffer, 0).expect("it fits");
    assert_eq!(Reply::decode(request), Err(ReplyError::NotFromScanner));
}

/// A scan of 361 values in mm has the 732 bytes that the manual's example has, and reads as it was
/// made.
//= laser.INV-7
//= laser.INV-8
#[test]
fn a_scan_by_hand() {
    let mut buffer = [0; MAX_TELEGRAM];
    let words = |index| match index {
        10 => 0x1FFF,
        11 => 0x1FFE,
        12 => 0x1FF7,
        20 => 2500 | 0x2000,
        30 => 2500 | 0x8000,
        index => 1000 + index,
    };
    let (variant, status) = (Variant::Degrees180StepHalf, Status(0x10));
    let telegram =
        Scan::encode(&mut buffer, 0, variant, Unit::Millimetre, status, words).expect("it fits");
    assert_eq!(telegram.as_bytes().len(), 732);
    assert_eq!(
        telegram.as_bytes()[..7],
        [2, 0x80, 0xD6, 2, 0xB0, 0x69, 0x41]
    );
    assert!(law::is_scan(telegram.as_bytes()));
    let scan = Scan::new_checked(telegram, MeasuringMode::FieldsAbDazzled).expect("a scan");
    assert_eq!((scan.variant(), scan.count()), (variant, 361));
    assert_eq!(scan.reading(0), Some(Reading::Range(1000)));
    assert_eq!(scan.reading(360), Some(Reading::Range(1360)));
    assert_eq!(scan.reading(361), None);
    let missing = |index| scan.reading(index).expect("a value");
    assert_eq!(missing(10), Reading::Missing(Missing::NoEcho));
    assert_eq!(missing(11), Reading::Missing(Missing::Dazzled));
    assert_eq!(missing(12), Reading::Missing(Missing::TooFar));
    assert_eq!(missing(30), Reading::Missing(Missing::Dazzled));
    assert_eq!(scan.reading(20), Some(Reading::Range(2500)));
    assert_eq!(variant.bearing(0), Some(-9000));
    assert_eq!(variant.bearing(180), Some(0));
    let angle = variant.bearing_angle(270).expect("a value").get();
    assert!((angle - core::f32::consts::FRAC_PI_4).abs() < 1e-6);
    assert_eq!(Variant::Degrees100Step1.bearing(0), Some(-5000));
    // In another mode the same bits are other values.
    let scan = Scan::new_checked(telegram, MeasuringMode::FieldsAbc).expect("a scan");
    assert_eq!(scan.reading(30), Some(Reading::Range(2500)));
    let scan = Scan::new_checked(telegram, MeasuringMode::RangeOnly).expect("a scan");
    assert_eq!(scan.reading(30), Some(Reading::Range(2500 + 0x8000)));
}

//= laser.INV-8
#[test]
fn what_is_no_whole_scan_is_refused() {
    let refused = |header: u16, values: usize, tail: &[u8], status: u8| {
        let mut buffer = [0; MAX_TELEGRAM];
        let telegram = TelegramWriter::reply(&mut buffer, 0, 0xB0)
            .u16(header)
            .bytes(&vec![0; 2 * values])
            .bytes(tail)
            .u8(status)
            .finish()
            .expect("it fits");
        let scan = Scan::new_checked(telegram, MeasuringMode::default());
        assert_eq!(scan.is_ok(), law::is_scan(telegram.as_bytes()));
        scan.err()
    };
    let millimetres = 1 << 14;
    let of = |count: u16| millimetres | count;
    assert_eq!(refused(of(181), 181, &[], 0x10), None);
    assert_eq!(refused(of(181), 181, &[1, 2], 0x92), None);
    assert_eq!(refused(181, 181, &[], 0x10), None);
    assert_eq!(
        refused(of(181), 181, &[1, 2, 3], 0x10),
        Some(ReplyError::Size { bytes: 367 })
    );
    assert_eq!(
        refused(of(181), 180, &[], 0x10),
        Some(ReplyError::Size { bytes: 362 })
    );
    assert_eq!(
        refused(of(180), 180, &[], 0x10),
        Some(ReplyError::Count(180))
    );
    assert_eq!(
        refused(of(181 | 0x400), 181, &[], 0x10),
        Some(ReplyError::Count(181 | 0x400))
    );
    assert_eq!(
        refused(181 | 2 << 14, 181, &[], 0x10),
        Some(ReplyError::Unit(2))
    );
    assert_eq!(
        refused(of(181 | 1 << 13 | 3 << 11), 181, &[], 0x10),
        Some(ReplyError::Partial(3))
    );
    for status in [0x13, 0x14, 0x17, 0x50] {
        assert_eq!(
            refused(of(181), 181, &[], status),
            Some(ReplyError::Status(Status(status)))
        );
    }
}

fn any_telegram() -> impl Strategy<Value = Vec<u8>> {
    (any::<u8>(), any::<u8>(), vec(any::<u8>(), 0..60)).prop_map(|(address, command, data)| {
        let mut buffer = [0; MAX_TELEGRAM];
        let telegram = TelegramWriter::reply(&mut buffer, address, command)
            .bytes(&data)
            .finish();
        telegram.expect("it fits").as_bytes().to_vec()
    })
}

/// Bytes of which many are the start of a telegram, or a short length.
fn any_bytes() -> impl Strategy<Value = Vec<u8>> {
    vec(prop_oneof![Just(2), Just(0), 0_u8..9, any::<u8>()], 0..40)
}

proptest! {
    #![proptest_config(common::cases(4_000))]

    //= laser.INV-1
    //= laser.INV-2
    #[test]
    fn any_bytes_are_checked(data in prop_oneof![any_bytes(), any_telegram()]) {
        let result = Telegram::new_checked(&data);
        prop_assert_eq!(result.is_ok(), law::begins_with_telegram(&data));
        prop_assert_eq!(checksum(&data), law::checksum(&data));
        if let Ok(telegram) = result {
            prop_assert!(law::is_telegram(telegram.as_bytes()));
            prop_assert!(law::is_view(&data, telegram.as_bytes(), telegram.data()));
            prop_assert_eq!(
                Scan::new_checked(telegram, MeasuringMode::default()).is_ok(),
                law::is_scan(telegram.as_bytes())
            );
            let _ = Reply::decode(telegram);
        }
    }

    /// One wrong bit is noticed, wherever it is.
    //= laser.INV-1
    #[test]
    fn a_telegram_that_is_damaged_is_refused(
        telegram in any_telegram(), place in any::<Index>(), bit in 0_u8..8, tail in any_bytes()
    ) {
        prop_assert_eq!(
            Telegram::new_checked(&[&telegram[..], &tail[..]].concat()).map(|t| t.as_bytes().len()),
            Ok(telegram.len())
        );
        for length in 0..telegram.len() {
            prop_assert_eq!(
                Telegram::new_checked(&telegram[..length]), Err(TelegramError::Truncated)
            );
        }
        let mut damaged = telegram.clone();
        damaged[place.index(telegram.len())] ^= 1 << bit;
        prop_assert!(Telegram::new_checked(&damaged).is_err());
    }

    //= laser.INV-3
    #[test]
    fn what_is_written_is_accepted(
        address in any::<u8>(), command in any::<u8>(), data in vec(any::<u8>(), 0..830)
    ) {
        let mut buffer = [0; MAX_TELEGRAM];
        match TelegramWriter::reply(&mut buffer, address, command).bytes(&data).finish() {
            Ok(telegram) => {
                prop_assert!(law::is_telegram_of(
                    telegram.as_bytes(), address | 0x80, command, &data
                ));
                prop_assert_eq!(telegram.data(), &data[..]);
            }
            Err(_) => prop_assert!(data.len() > 811),
        }
    }

    //= laser.INV-2
    //= laser.INV-4
    //= laser.INV-5
    #[test]
    fn nothing_is_lost(
        parts in vec(prop_oneof![any_telegram(), any_bytes()], 0..8),
        damage in any::<Option<(Index, u8)>>(),
        pieces in vec(1_usize..200, 1..5),
    ) {
        let mut stream = parts.concat();
        if let Some((place, with)) = damage && !stream.is_empty() {
            let place = place.index(stream.len());
            stream[place] = with;
        }
        let mut receiver = Receiver::new();
        let skipped = |receiver: &Receiver| receiver.reception().skipped_bytes as usize;
        let mut delivered = Vec::new();
        let mut inside = 0;
        let mut rest = &stream[..];
        let mut sizes = pieces.iter().copied().cycle();
        while !rest.is_empty() {
            let size = sizes.next().unwrap_or(1).min(rest.len());
            let (mut piece, later) = rest.split_at(size);
            while let Some(telegram) = receiver.next_frame(&mut piece) {
                let length = telegram.as_bytes().len();
                delivered.push((inside + skipped(&receiver), length));
                inside += length;
            }
            prop_assert!(piece.is_empty());
            rest = later;
        }
        let skipped_in_all = skipped(&receiver);
        prop_assert!(law::nothing_is_lost(&stream, &delivered, inside + skipped_in_all));
        prop_assert!(law::all_bytes_are_accounted_for(
            stream.len(), inside, skipped_in_all, stream.len() - inside - skipped_in_all
        ));
    }

    //= laser.INV-6
    //= laser.INV-7
    //= laser.INV-8
    #[test]
    fn scans_come_back(
        variant in select(&Variant::ALL[..]),
        mode in select(&MeasuringMode::ALL[..]),
        millimetres in any::<bool>(),
        seed in any::<u16>(),
        status in any::<u8>(),
    ) {
        let unit = if millimetres { Unit::Millimetre } else { Unit::Centimetre };
        let word = |index: u16| {
            let word = index.wrapping_mul(40_503).wrapping_add(seed);
            // Codes and what is next to them, now and then.
            if word.is_multiple_of(5) { word | 0x1FF0 } else { word }
        };
        let mut buffer = [0; MAX_TELEGRAM];
        let telegram = Scan::encode(&mut buffer, 5, variant, unit, Status(status), word);
        let telegram = telegram.expect("it fits");
        let scan = Scan::new_checked(telegram, mode);
        prop_assert_eq!(scan.is_ok(), law::is_scan(telegram.as_bytes()));
        prop_assert_eq!(scan.is_ok(), Status(status).is_usable());
        let Ok(scan) = scan else { return Ok(()) };
        prop_assert_eq!((scan.variant(), scan.unit()), (variant, unit));
        let bits = 16 - mode.mask().leading_zeros();
        for index in 0..variant.count() + 3 {
            prop_assert!(law::is_bearing(
                u32::from(index),
                u32::from(variant.field_of_view()),
                u32::from(variant.step()),
                variant.bearing(index).map(i64::from)
            ));
            if index >= variant.count() {
                prop_assert_eq!(scan.reading(index), None);
                continue;
            }
            let dazzled = mode == MeasuringMode::FieldsAbDazzled && word(index) >= 0x8000;
            let range = match scan.reading(index) {
                Some(Reading::Range(range)) => Some(range),
                _ => None,
            };
            let length = if millimetres { 1 } else { 10 };
            prop_assert!(law::is_reading(word(index), bits, length, dazzled, range));
        }
    }
}

/// Every error and every missing value says what was wrong, with the numbers.
#[test]
fn errors_name_what_was_wrong() {
    let said = [
        (TelegramError::Start.to_string(), "begins"),
        (
            TelegramError::Length(813).to_string(),
            "813 bytes, allowed is 1 to 812",
        ),
        (TelegramError::Truncated.to_string(), "truncated"),
        (
            TelegramError::Checksum {
                computed: 0xABCD,
                carried: 0x12,
            }
            .to_string(),
            "checksum 0012, its bytes have ABCD",
        ),
        (ReplyError::NotFromScanner.to_string(), "host"),
        (ReplyError::Command(0xB1).to_string(), "B1"),
        (ReplyError::Size { bytes: 3 }.to_string(), "3 bytes"),
        (
            ReplyError::Unit(2).to_string(),
            "unit 2, allowed is 0 (cm) or 1 (mm)",
        ),
        (ReplyError::Partial(1).to_string(), "part 1"),
        (ReplyError::Count(7).to_string(), "7 values"),
        (
            ReplyError::Status(Status(0x43)).to_string(),
            "Error, values implausible (status 43)",
        ),
        (
            ReplyError::Status(Status(0x04)).to_string(),
            "Fatal (status 04)",
        ),
        (Missing::NoEcho.to_string(), "no echo"),
        (Missing::Dazzled.to_string(), "dazzled"),
        (Missing::Overflow.to_string(), "overflow"),
        (Missing::WeakEcho.to_string(), "weak"),
        (Missing::ChannelError.to_string(), "channel"),
        (Missing::TooFar.to_string(), "far"),
        (Missing::Reserved.to_string(), "reserved"),
    ];
    for (message, part) in said {
        assert!(message.contains(part), "{message:?} does not say {part:?}");
    }
    assert!(Status(0x80).is_polluted() && !Status(0x7F).is_polluted());
}
