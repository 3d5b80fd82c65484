//! Bytes as a stream from either end of the line, and as the arguments of the robot's packets.

use sidestep::arcos::{
    BoundedReceiver, Configuration, Frame, FrameWriter, HostCommand, Identity, MAX_FRAME, Odometry,
    Receiver, StandardInformation, compass_heading_deg, shortest_delta,
};
use sidestep_spec::arcos as law;

/// The bytes as a stream, handed over in pieces whose size the first byte tells.
///
/// # Panics
/// If a predicate of the law book is broken.
pub fn frame(data: &[u8]) {
    let Some((size, stream)) = data.split_first() else {
        return;
    };
    let piece = usize::from(*size).max(1);
    receive(&mut Receiver::new(), stream, piece);
    receive(&mut BoundedReceiver::<16>::new(), stream, piece);

    let found = Frame::new_checked(stream);
    assert_eq!(found.is_ok(), law::begins_with_frame(stream));
    if let Ok(frame) = found {
        assert!(law::is_view(stream, frame.as_bytes(), frame.arguments()));
    }
}

fn receive<const LONGEST: usize>(
    receiver: &mut BoundedReceiver<LONGEST>,
    stream: &[u8],
    piece: usize,
) {
    let skipped = |receiver: &BoundedReceiver<LONGEST>| {
        usize::try_from(receiver.reception().skipped_bytes).expect("few")
    };
    let mut delivered = Vec::new();
    let mut inside = 0;
    for mut piece in stream.chunks(piece) {
        while let Some(frame) = receiver.next_frame(&mut piece) {
            assert!(law::is_frame(frame.as_bytes()));
            let (length, number) = (frame.as_bytes().len(), frame.number());
            reencode(frame);
            decode(frame);
            delivered.push((inside + skipped(receiver), length));
            inside += length;
            assert_eq!(number, stream[delivered[delivered.len() - 1].0 + 3]);
        }
        assert!(piece.is_empty());
    }
    let skipped = skipped(receiver);
    let held = stream.len() - inside - skipped;
    assert!(law::all_bytes_are_accounted_for(
        stream.len(),
        inside,
        skipped,
        held
    ));
    // What is longer than the receiver takes is no frame to it.
    assert!(LONGEST < MAX_FRAME || law::nothing_is_lost(stream, &delivered, inside + skipped));
}

fn reencode(frame: Frame<'_>) {
    let command = HostCommand::decode(frame);
    let mut buffer = [0; MAX_FRAME];
    let again = command.encode(&mut buffer).expect("it came from a frame");
    assert!(law::is_unchanged(frame.as_bytes(), again.as_bytes()));
    if let Some(value) = command.integer() {
        let bytes = <[u8; 3]>::try_from(frame.arguments()).expect("type and magnitude");
        assert!(law::is_integer_encodable(value) && law::is_integer_argument(value, bytes));
    }
}

fn decode(frame: Frame<'_>) {
    if let Ok(identity) = Identity::decode(frame) {
        assert!(law::is_text(identity.name));
        assert!(law::is_text(identity.class));
        assert!(law::is_text(identity.subclass));
    }
    if let Ok(configuration) = Configuration::decode(frame) {
        assert!(law::is_text(configuration.name));
        assert!(configuration.firmware.is_none_or(law::is_text));
    }
    let information = StandardInformation::decode(frame);
    assert_eq!(
        information.is_ok(),
        law::is_information(frame.number(), frame.arguments())
    );
}

/// The first byte as a packet's type, the rest as the arguments of one packet after the other, each
/// behind a byte that tells its length. The odometry follows those that are SIPs.
///
/// # Panics
/// If a predicate of the law book is broken.
pub fn information(data: &[u8]) {
    let Some((kind, mut rest)) = data.split_first() else {
        return;
    };
    let mut odometry = Odometry::new();
    let mut last = None;
    while let Some((length, packets)) = rest.split_first() {
        let (arguments, later) = packets.split_at(packets.len().min(usize::from(*length).min(246)));
        rest = later;
        let mut buffer = [0; MAX_FRAME];
        let frame = FrameWriter::new(&mut buffer, *kind)
            .bytes(arguments)
            .finish()
            .expect("it fits");
        assert!(law::is_frame_of(frame.as_bytes(), *kind, arguments));
        decode(frame);
        let Ok(information) = StandardInformation::decode(frame) else {
            continue;
        };
        encode(&information);
        assert!(law::is_compass_heading(
            information.compass,
            compass_heading_deg(information.compass)
        ));

        let before = odometry.units();
        odometry.update(information.x, information.y);
        let after = odometry.units();
        assert!(law::is_one_step(before.0, after.0) && law::is_one_step(before.1, after.1));
        let moved = (after.0 - before.0, after.1 - before.1);
        let expected = last.map_or((0, 0), |(x, y)| {
            let (dx, dy) = (
                shortest_delta(x, information.x),
                shortest_delta(y, information.y),
            );
            assert!(law::is_shortest_delta(x, information.x, dx));
            assert!(law::is_shortest_delta(y, information.y, dy));
            (i64::from(dx), i64::from(dy))
        });
        assert_eq!(moved, expected);
        last = Some((information.x, information.y));
    }
}

fn encode(information: &StandardInformation) {
    let mut buffer = [0; MAX_FRAME];
    let frame = information
        .encode(&mut buffer)
        .expect("it came from a frame");
    assert_eq!(StandardInformation::decode(frame).as_ref(), Ok(information));
    let words = [
        information.x,
        information.y,
        information.heading.cast_unsigned(),
        information.left_velocity.cast_unsigned(),
        information.right_velocity.cast_unsigned(),
        information.control.cast_unsigned(),
        information.flags,
    ];
    assert!(law::holds_words(frame.arguments(), words));
}
