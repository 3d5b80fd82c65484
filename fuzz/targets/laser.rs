//! Bytes as a stream from the laser scanner.

use sidestep::laser::{
    MAX_TELEGRAM, MeasuringMode, Reading, Receiver, Reply, Scan, Telegram, TelegramWriter,
};
use sidestep_spec::laser as law;

/// The bytes as a stream, handed over in pieces whose size the first byte tells; then all of them as
/// the data of one telegram, since a fuzzer seldom finds a checksum.
///
/// # Panics
/// If a predicate of the law book is broken.
pub fn run(data: &[u8]) {
    let Some((size, stream)) = data.split_first() else {
        return;
    };
    receive(stream, usize::from(*size).max(1));
    let found = Telegram::new_checked(stream);
    assert_eq!(found.is_ok(), law::begins_with_telegram(stream));

    let mut buffer = [0; MAX_TELEGRAM];
    let written = TelegramWriter::reply(&mut buffer, *size, 0xB0)
        .bytes(stream)
        .finish();
    assert_eq!(written.is_ok(), stream.len() < 812);
    if let Ok(telegram) = written {
        let bytes = telegram.as_bytes();
        assert!(law::is_telegram_of(bytes, size | 128, 0xB0, stream));
        decode(telegram);
    }
    if let Some((command, rest)) = stream.split_first() {
        let mut buffer = [0; MAX_TELEGRAM];
        if let Ok(telegram) = TelegramWriter::reply(&mut buffer, *size, *command)
            .bytes(rest)
            .finish()
        {
            decode(telegram);
        }
    }
}

fn receive(stream: &[u8], piece: usize) {
    let mut receiver = Receiver::new();
    let skipped = |receiver: &Receiver| receiver.reception().skipped_bytes as usize;
    let mut delivered = Vec::new();
    let mut inside = 0;
    for mut piece in stream.chunks(piece) {
        while let Some(telegram) = receiver.next_frame(&mut piece) {
            let length = telegram.as_bytes().len();
            assert!(law::is_view(
                telegram.as_bytes(),
                telegram.as_bytes(),
                telegram.data()
            ));
            decode(telegram);
            delivered.push((inside + skipped(&receiver), length));
            inside += length;
        }
        assert!(piece.is_empty());
    }
    let skipped = skipped(&receiver);
    assert!(law::nothing_is_lost(stream, &delivered, inside + skipped));
    assert!(law::all_bytes_are_accounted_for(
        stream.len(),
        inside,
        skipped,
        stream.len() - inside - skipped
    ));
}

fn decode(telegram: Telegram<'_>) {
    let _ = Reply::decode(telegram);
    for mode in MeasuringMode::ALL {
        let scan = Scan::new_checked(telegram, mode);
        assert_eq!(scan.is_ok(), law::is_scan(telegram.as_bytes()));
        let Ok(scan) = scan else { continue };
        assert!(scan.reading(scan.count()).is_none());
        for index in 0..scan.count() {
            let word = scan.word(index).expect("a value");
            let range = match scan.reading(index).expect("a value") {
                Reading::Range(range) => Some(range),
                Reading::Missing(_) => None,
            };
            assert!(law::is_reading(
                word,
                16 - mode.mask().leading_zeros(),
                scan.unit().millimetres(),
                mode == MeasuringMode::FieldsAbDazzled && word >= 0x8000,
                range
            ));
        }
    }
}
