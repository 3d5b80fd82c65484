//! Chapter `laser`: the codec of the laser scanner's telegrams.

#[cfg(not(kani))]
use super::kani;
use sidestep::laser::{
    MeasuringMode, Reading, Telegram, TelegramError, TelegramWriter, Unit, Variant, checksum,
};
use sidestep_spec::laser as law;

/// The checksum is the specification's, for any 5 bytes or fewer. Two bytes already lead to any sum, with
/// and without a carry to come, and each further byte repeats the same step.
//= laser.INV-1
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(7))]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn checksum_is_as_specified() {
    let bytes: [u8; 5] = kani::any();
    let length = usize::from(kani::any::<u8>() % 6);
    let bytes = bytes.get(..length).unwrap_or_default();
    let sum = law::checksum(bytes);
    assert_eq!(checksum(bytes), sum);
    kani::cover!(length == 5, "the longest");
    kani::cover!(length < 5 && sum >= 0x8000, "a sum that would carry");
}

/// Bytes are a telegram exactly if the specification says so, and a telegram is a view within them,
/// for any bytes up to 8. `Truncated` is said only as long as bytes are missing.
//= laser.INV-1
//= laser.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(10))]
#[cfg_attr(kani, kani::solver(minisat))]
pub fn telegram_is_checked() {
    let bytes: [u8; 8] = kani::any();
    let length = usize::from(kani::any::<u8>() % 9);
    let bytes = bytes.get(..length).unwrap_or_default();
    let result = Telegram::new_checked(bytes);
    assert_eq!(result.is_ok(), law::begins_with_telegram(bytes));
    match result {
        Ok(telegram) => {
            assert!(law::is_view(bytes, telegram.as_bytes(), telegram.data()));
            assert_eq!(bytes.get(4), Some(&telegram.command()));
            kani::cover!(telegram.data().len() == 1, "data");
            kani::cover!(telegram.is_from_scanner(), "a reply");
        }
        Err(TelegramError::Truncated) => {
            let whole = match *bytes {
                [_, _, low, high, ..] => usize::from(u16::from_le_bytes([low, high])) + 6,
                _ => 6,
            };
            assert!(whole > length);
            kani::cover!(length >= 4, "a truncated telegram");
        }
        Err(TelegramError::Checksum { computed, carried }) => {
            kani::cover!(computed > carried, "a bad checksum");
        }
        Err(TelegramError::Length(length)) => {
            kani::cover!(length == 0, "an empty payload");
            kani::cover!(length == 813, "a payload just too long");
        }
        Err(TelegramError::Start) => {
            kani::cover!(length == 1, "something else");
        }
    }
}

/// What the writer finishes is a telegram with the address, command and `N` bytes of data it was
/// given.
fn written_telegram<const N: usize>(buffer: &mut [u8]) {
    let (address, command, data): (u8, u8, [u8; N]) = (kani::any(), kani::any(), kani::any());
    let telegram = TelegramWriter::reply(buffer, address, command)
        .bytes(&data)
        .finish();
    assert!(telegram.is_ok());
    if let Ok(telegram) = telegram {
        assert!(telegram.is_from_scanner() && telegram.address() == address % 128);
        assert!(telegram.command() == command && telegram.data() == data);
        assert!(law::is_telegram_of(
            telegram.as_bytes(),
            address % 128 + 128,
            command,
            &data
        ));
    }
}

/// What the writer finishes is a telegram with what it was given, for any data of 0 and 1 bytes.
//= laser.INV-3
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(12))]
#[cfg_attr(kani, kani::solver(minisat))]
pub fn written_telegram_is_accepted() {
    written_telegram::<0>(&mut [0; 7]);
    written_telegram::<1>(&mut [0; 8]);
    let short = &mut [0; 7];
    kani::cover!(
        TelegramWriter::request(short, 0, 0).u8(0).finish().is_err(),
        "a buffer too short"
    );
}

/// Every word in every mode and unit is a range or the reason why there is none, as specified.
//= laser.INV-6
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(minisat))]
pub fn values_are_ranges_or_missing() {
    let word: u16 = kani::any();
    let mode = MeasuringMode::ALL[usize::from(kani::any::<u8>() % 8)];
    let unit = if kani::any() {
        Unit::Millimetre
    } else {
        Unit::Centimetre
    };
    let bits = match mode {
        MeasuringMode::RangeOnly => 16,
        MeasuringMode::Reflector1 | MeasuringMode::FieldA => 15,
        MeasuringMode::Reflector2 | MeasuringMode::FieldsAb => 14,
        _ => 13,
    };
    let dazzled = matches!(mode, MeasuringMode::FieldsAbDazzled) && word >= 0x8000;
    let range = match mode.reading(word, unit) {
        Reading::Range(range) => Some(range),
        Reading::Missing(_) => None,
    };
    assert!(law::is_reading(
        word,
        bits,
        unit.millimetres(),
        dazzled,
        range
    ));
    kani::cover!(range.is_some_and(|range| range > 80_000), "a long range");
    kani::cover!(range == Some(0), "a range of zero");
    kani::cover!(range.is_none() && !dazzled, "a code");
}

/// Every value of every variant lies where it should, and there is none beyond the last.
//= laser.INV-7
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(7))]
#[cfg_attr(kani, kani::solver(minisat))]
pub fn bearings_are_in_order() {
    let variant = Variant::ALL[usize::from(kani::any::<u8>() % 5)];
    let index: u16 = kani::any();
    let bearing = variant.bearing(index);
    assert!(law::is_bearing(
        u32::from(index),
        u32::from(variant.field_of_view()),
        u32::from(variant.step()),
        bearing.map(i64::from)
    ));
    assert!(Variant::of_count(variant.count()) == Some(variant));
    kani::cover!(bearing == Some(9000), "the leftmost");
    kani::cover!(bearing.is_none(), "beyond");
}
