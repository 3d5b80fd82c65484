//! Chapter `arcos`: the codec of the serial protocol.

#[cfg(not(kani))]
use super::kani;
use sidestep::arcos::{
    Argument, BoundedReceiver, EncodeError, Frame, FrameError, FrameWriter, HostCommand, Identity,
    Odometry, PacketError, StandardInformation, checksum, compass_heading_deg, shortest_delta,
};
use sidestep_spec::arcos as law;

/// Stands in for the checksum where only what it lets through matters: with the same sum for every
/// packet, a frame of any contents passes. That the real one is as specified is proved below.
#[cfg_attr(not(kani), allow(dead_code))]
pub fn same_for_all(_packet: &[u8]) -> u16 {
    0
}

/// Any frame with `N` bytes of arguments and a good checksum.
fn any_frame<const N: usize>(number: u8, buffer: &mut [u8]) -> Option<Frame<'_>> {
    let arguments: [u8; N] = kani::any();
    FrameWriter::new(buffer, number)
        .bytes(&arguments)
        .finish()
        .ok()
}

/// The checksum is the specification's, for any packet of up to 12 bytes. Each further pair of
/// bytes repeats the same step.
//= arcos.INV-1
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(14))]
#[cfg_attr(kani, kani::solver(minisat))]
pub fn checksum_is_as_specified() {
    let bytes: [u8; 12] = kani::any();
    let length = usize::from(kani::any::<u8>() % 13);
    let packet = bytes.get(..length).unwrap_or_default();
    assert_eq!(checksum(packet), law::checksum(packet));
    kani::cover!(length == 12, "the longest packet");
    kani::cover!(length % 2 == 1, "an odd packet");
}

/// Bytes are a frame exactly if the specification says so, and a frame is a view within them, for
/// any bytes up to 12. `Truncated` is said only as long as bytes are missing.
//= arcos.INV-1
//= arcos.INV-2
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(14))]
#[cfg_attr(kani, kani::solver(minisat))]
pub fn frame_is_checked() {
    let bytes: [u8; 12] = kani::any();
    let length = usize::from(kani::any::<u8>() % 13);
    let bytes = bytes.get(..length).unwrap_or_default();
    let result = Frame::new_checked(bytes);
    assert_eq!(result.is_ok(), law::begins_with_frame(bytes));
    match result {
        Ok(frame) => {
            assert!(law::is_view(bytes, frame.as_bytes(), frame.arguments()));
            assert_eq!(bytes.get(3), Some(&frame.number()));
            kani::cover!(frame.arguments().len() == 6, "arguments");
        }
        Err(FrameError::Truncated) => {
            let whole = bytes.get(2).map(|count| usize::from(*count) + 3);
            assert!(whole.is_none_or(|whole| whole > length));
            kani::cover!(whole.is_some(), "a truncated frame");
        }
        Err(FrameError::Checksum { computed, carried }) => {
            kani::cover!(computed > carried, "a bad checksum");
        }
        Err(FrameError::Count(count)) => {
            kani::cover!(count == 250, "a count just too large");
            kani::cover!(count == 2, "a count just too small");
        }
        Err(FrameError::Header) => {
            kani::cover!(length == 2, "half a header");
        }
    }
}

/// What the writer finishes is a frame with the number and `N` bytes of arguments it was given.
fn written_frame<const N: usize>(buffer: &mut [u8]) {
    let (number, arguments): (u8, [u8; N]) = (kani::any(), kani::any());
    let frame = FrameWriter::new(buffer, number).bytes(&arguments).finish();
    assert!(frame.is_ok());
    if let Ok(frame) = frame {
        assert!(frame.number() == number && frame.arguments() == arguments);
        assert!(law::is_frame_of(frame.as_bytes(), number, &arguments));
    }
}

/// What the writer finishes is a frame with the number and arguments it was given, for any
/// arguments of 0, 1, 2, 3 and 8 bytes: none, and odd and even packets.
//= arcos.INV-3
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(12))]
#[cfg_attr(kani, kani::solver(minisat))]
pub fn written_frame_is_accepted() {
    written_frame::<0>(&mut [0; 6]);
    written_frame::<1>(&mut [0; 7]);
    written_frame::<2>(&mut [0; 8]);
    written_frame::<3>(&mut [0; 9]);
    written_frame::<8>(&mut [0; 14]);
    let short = &mut [0; 6];
    kani::cover!(
        FrameWriter::new(short, 0).u8(0).finish().is_err(),
        "a buffer too short"
    );
}

/// Each byte of a stream into a receiver of short frames is delivered, skipped or held. The first of
/// the results is how many were delivered, the second how many skipped.
fn received<const N: usize>(stream: [u8; N]) -> (usize, usize) {
    let mut receiver = BoundedReceiver::<6>::new();
    let mut input = stream.as_slice();
    let delivered = match receiver.next_frame(&mut input) {
        Some(frame) => frame.as_bytes().len(),
        None => 0,
    };
    let skipped = usize::try_from(receiver.reception().skipped_bytes).unwrap_or(usize::MAX);
    assert!(input.is_empty() && delivered + skipped <= N);
    let held = N - delivered - skipped;
    assert!(law::all_bytes_are_accounted_for(
        N, delivered, skipped, held
    ));
    (delivered, skipped)
}

/// Any 6 bytes into a receiver for frames of at most 6, and any number and checksum of a frame behind
/// a byte of noise, for which its buffer has to be moved: each byte is delivered, skipped or held. The
/// same code at its full length is left to the property tests and the fuzzer.
//= arcos.INV-2
//= arcos.INV-5
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(11))]
#[cfg_attr(kani, kani::solver(minisat))]
#[cfg_attr(
    kani,
    kani::stub(crate::arcos::checksum, crate::proofs::arcos::same_for_all)
)]
pub fn receiver_loses_nothing() {
    let (delivered, skipped) = received::<6>(kani::any());
    kani::cover!(delivered == 6, "a frame");
    kani::cover!(skipped == 4, "the beginning of a frame behind other bytes");
    let [number, high, low] = kani::any();
    let (delivered, _) = received([0x00, 0xFA, 0xFB, 3, number, high, low]);
    kani::cover!(delivered == 6, "a frame behind another byte");
}

/// A frame with `N` bytes of arguments is encoded again byte for byte.
fn reencoded<'b, const N: usize>(buffer: &'b mut [u8], again: &mut [u8]) -> Argument<'b> {
    let Some(frame) = any_frame::<N>(kani::any(), buffer) else {
        unreachable!("the buffer holds the frame");
    };
    let command = HostCommand::decode(frame);
    let again = command.encode(again);
    assert!(again.is_ok_and(|again| law::is_unchanged(frame.as_bytes(), again.as_bytes())));
    command.argument
}

/// Every host frame of up to 5 bytes of arguments is encoded again byte for byte. That covers every
/// form of argument; longer ones are strings and what is kept as received.
//= arcos.INV-2
//= arcos.INV-6
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(13))]
#[cfg_attr(kani, kani::solver(minisat))]
#[cfg_attr(
    kani,
    kani::stub(crate::arcos::checksum, crate::proofs::arcos::same_for_all)
)]
pub fn host_frame_is_reencoded() {
    assert_eq!(reencoded::<0>(&mut [0; 6], &mut [0; 6]), Argument::None);
    match reencoded::<1>(&mut [0; 7], &mut [0; 7]) {
        Argument::Unvalued(kind) => kani::cover!(kind == 0x3B, "a type byte alone"),
        _ => kani::cover!(true, "a byte that is no type"),
    }
    reencoded::<2>(&mut [0; 8], &mut [0; 8]);
    match reencoded::<3>(&mut [0; 9], &mut [0; 9]) {
        Argument::Integer(value) => kani::cover!(value < 0, "a negative integer"),
        Argument::Bytes { high, .. } => kani::cover!(high == 0x80, "two bytes"),
        Argument::Raw(raw) => kani::cover!(raw == [0x1B, 0, 0], "a negative zero"),
        _ => {}
    }
    match reencoded::<5>(&mut [0; 11], &mut [0; 11]) {
        Argument::Text(text) => kani::cover!(text.len() == 3, "a string"),
        _ => kani::cover!(true, "a string of the wrong length"),
    }
}

/// Every integer that the protocol can express comes back; every other is refused.
//= arcos.INV-7
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(8))]
#[cfg_attr(kani, kani::solver(minisat))]
pub fn integer_comes_back() {
    let value: i32 = kani::any();
    let command = HostCommand::velocity(value);
    let mut buffer = [0; 9];
    let frame = command.encode(&mut buffer);
    assert_eq!(frame.is_ok(), law::is_integer_encodable(value));
    match frame {
        Ok(frame) => {
            let bytes = <[u8; 3]>::try_from(frame.arguments());
            assert!(bytes.is_ok_and(|bytes| law::is_integer_argument(value, bytes)));
            assert_eq!(HostCommand::decode(frame), command);
        }
        Err(error) => assert_eq!(error, EncodeError::Integer(value)),
    }
    kani::cover!(value == -65_535 && frame.is_ok(), "the least");
    kani::cover!(value == i32::MIN, "far below it");
}

/// A packet with any `N` bytes of arguments is a SIP exactly if the specification says so.
fn judged<const N: usize>(buffer: &mut [u8]) -> Result<StandardInformation, PacketError> {
    let Some(frame) = any_frame::<N>(kani::any(), buffer) else {
        unreachable!("the buffer holds the frame");
    };
    let result = StandardInformation::decode(frame);
    let expected = law::is_information(frame.number(), frame.arguments());
    assert_eq!(result.is_ok(), expected);
    result
}

/// Any packet of 28 bytes of arguments, which has room for three readings, is a SIP exactly if the
/// specification says so.
//= arcos.INV-2
//= arcos.INV-9
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(5))]
#[cfg_attr(kani, kani::solver(minisat))]
#[cfg_attr(
    kani,
    kani::stub(crate::arcos::checksum, crate::proofs::arcos::same_for_all)
)]
pub fn information_is_checked() {
    match judged::<28>(&mut [0; 34]) {
        Ok(information) => {
            kani::cover!(information.sonars.as_slice().len() == 3, "three readings");
        }
        Err(PacketError::SonarsMissing { claimed, .. }) => {
            kani::cover!(claimed == 16, "sixteen readings claimed");
        }
        Err(PacketError::SonarIndex(index)) => kani::cover!(index == 255, "no such sonar"),
        Err(PacketError::TooManySonars(_)) => kani::cover!(true, "too many readings"),
        Err(_) => {}
    }
}

/// The same for packets of 18 and 21 bytes of arguments: too short, and with part of a reading.
//= arcos.INV-2
//= arcos.INV-8
//= arcos.INV-9
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(3))]
#[cfg_attr(kani, kani::solver(minisat))]
#[cfg_attr(
    kani,
    kani::stub(crate::arcos::checksum, crate::proofs::arcos::same_for_all)
)]
pub fn short_information_is_checked() {
    assert!(judged::<18>(&mut [0; 24]).is_err());
    match judged::<21>(&mut [0; 27]) {
        Ok(_) => kani::cover!(true, "no reading"),
        Err(_) => kani::cover!(true, "two thirds of a reading"),
    }
}

/// The robot's strings lie within the packet and hold no NUL, for any 10 bytes of arguments.
//= arcos.INV-2
//= arcos.INV-14
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(16))]
#[cfg_attr(kani, kani::solver(minisat))]
#[cfg_attr(
    kani,
    kani::stub(crate::arcos::checksum, crate::proofs::arcos::same_for_all)
)]
pub fn strings_are_bounded() {
    let mut buffer = [0; 16];
    if let Some(frame) = any_frame::<10>(2, &mut buffer) {
        let identity = Identity::decode(frame);
        if let Ok(identity) = identity {
            assert!(law::is_text(identity.name));
            assert!(law::is_text(identity.class));
            assert!(law::is_text(identity.subclass));
            assert!(identity.name.len() + identity.class.len() + identity.subclass.len() <= 8);
        }
        kani::cover!(
            identity.is_ok_and(|identity| identity.subclass.len() == 4),
            "a subclass"
        );
        kani::cover!(identity.is_err(), "no subclass");
    }
}

/// A displacement is the shortest, for any two counters.
//= arcos.INV-11
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(minisat))]
pub fn displacement_is_shortest() {
    let (previous, current) = (kani::any(), kani::any());
    let delta = shortest_delta(previous, current);
    assert!(law::is_shortest_delta(previous, current, delta));
    kani::cover!(delta == -16_384, "half way round");
    kani::cover!(
        previous == 32_767 && current == 0 && delta == 1,
        "the wrap of 15 bits"
    );
    kani::cover!(
        previous == 65_535 && current == 0 && delta == 1,
        "the wrap of 16 bits"
    );
}

/// Any three SIPs move the position by no more than one step each, the first by none.
//= arcos.INV-12
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(minisat))]
pub fn odometry_moves_by_steps() {
    let mut odometry = Odometry::new();
    odometry.update(kani::any(), kani::any());
    assert_eq!(odometry.units(), (0, 0));
    odometry.update(kani::any(), kani::any());
    let before = odometry.units();
    let rebased = kani::any();
    if rebased {
        odometry.rebase();
    }
    odometry.update(kani::any(), kani::any());
    let after = odometry.units();
    assert!(law::is_one_step(before.0, after.0) && law::is_one_step(before.1, after.1));
    assert!(!rebased || before == after);
    kani::cover!(
        after.0 < before.0 && after.1 > before.1,
        "back and to the left"
    );
}

/// A compass byte gives a heading within 1° of both conventions, or none.
//= arcos.INV-13
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(minisat))]
pub fn compass_is_within_conventions() {
    let byte = kani::any();
    let heading = compass_heading_deg(byte);
    assert!(law::is_compass_heading(byte, heading));
    kani::cover!(heading == Some(359), "almost round");
    kani::cover!(byte == 181 && heading.is_none(), "no compass");
}
