//! A line does to packets what it was told to, and no more.

mod common;

use common::integer;
use sidestep_sim::link::{Faults, Link};

/// Sends 1000 packets, one every 100 ms, and returns what arrived: number sent, when it arrived (ms).
fn sent_through(faults: Faults, seed: u64) -> Vec<(usize, u64)> {
    let mut link = Link::new(faults, seed).unwrap();
    let packets: Vec<Vec<u8>> = (0..1000).map(|n| integer(11, n)).collect();
    let mut arrived = Vec::new();
    for time in (0..200_000).step_by(10) {
        if time % 100 == 0
            && let Some(packet) = packets.get(time / 100)
        {
            link.send(packet, time as u64, time as u64);
        }
        for packet in link.arrivals(time as u64) {
            let number = packets.iter().position(|sent| *sent == packet.bytes);
            let number = number.expect("only what was sent arrives");
            assert_eq!(packet.basis_ms, number as u64 * 100);
            arrived.push((number, time as u64));
        }
    }
    arrived
}

fn in_order(arrived: &[(usize, u64)]) -> bool {
    arrived.is_sorted_by_key(|(number, _)| *number)
}

#[test]
fn a_good_line_delivers_everything_at_once() {
    let arrived = sent_through(Faults::default(), 1);
    let expected: Vec<(usize, u64)> = (0..1000).map(|n| (n, n as u64 * 100)).collect();
    assert_eq!(arrived, expected);
}

#[test]
fn packets_are_lost_as_told() {
    let faults = Faults {
        loss: 0.3,
        ..Faults::default()
    };
    let arrived = sent_through(faults, 1);
    assert!((650..750).contains(&arrived.len()), "{}", arrived.len());
    assert!(in_order(&arrived));
    assert_eq!(arrived, sent_through(faults, 1));
    assert_ne!(arrived, sent_through(faults, 2));
    assert_eq!(
        sent_through(
            Faults {
                loss: 1.0,
                ..faults
            },
            1
        ),
        []
    );
}

#[test]
fn delays_are_bounded_and_keep_the_order() {
    for delay_ms in [30, 250] {
        let faults = Faults {
            delay_ms,
            ..Faults::default()
        };
        let arrived = sent_through(faults, 1);
        assert_eq!(arrived.len(), 1000);
        assert!(in_order(&arrived));
        let delays = arrived.iter().map(|(n, time)| time - *n as u64 * 100);
        let longest = delays.max().unwrap();
        // Arrivals are asked for every 10 ms.
        assert!(
            longest > delay_ms / 2 && longest <= delay_ms + 10,
            "{longest}"
        );
    }
}

#[test]
fn packets_come_twice_as_told() {
    let faults = Faults {
        duplication: 0.5,
        ..Faults::default()
    };
    let arrived = sent_through(faults, 1);
    assert!((1430..1570).contains(&arrived.len()), "{}", arrived.len());
    assert!(in_order(&arrived));
    let mut numbers: Vec<usize> = arrived.iter().map(|(n, _)| *n).collect();
    numbers.dedup();
    assert_eq!(numbers, (0..1000).collect::<Vec<_>>());
}

#[test]
fn packets_overtake_those_that_are_held_back() {
    let faults = Faults {
        reordering: 0.3,
        hold_ms: 250,
        ..Faults::default()
    };
    let arrived = sent_through(faults, 1);
    assert_eq!(arrived.len(), 1000);
    let overtaken = arrived.windows(2).filter(|pair| pair[0].0 > pair[1].0);
    let overtaken = overtaken.count();
    assert!((100..300).contains(&overtaken), "{overtaken}");
    let late = |(n, time): &(usize, u64)| time - *n as u64 * 100;
    assert!(arrived.iter().map(late).all(|delay| delay <= 260));
}

#[test]
fn a_packet_cut_in_pieces_arrives_whole() {
    let mut link = Link::new(Faults::default(), 0).unwrap();
    let packet = integer(11, 200);
    link.send(&[1, 2, 3], 0, 0);
    link.send(&packet[..4], 10, 10);
    assert_eq!(link.arrivals(10), []);
    link.send(&packet[4..], 20, 20);
    let arrived = link.arrivals(20);
    assert_eq!(arrived.len(), 1);
    assert_eq!(arrived[0].bytes, packet);
}

#[test]
fn what_cannot_be_is_refused() {
    let good = Faults::default();
    for faults in [
        Faults { loss: 1.1, ..good },
        Faults {
            duplication: f64::NAN,
            ..good
        },
        Faults {
            reordering: -0.1,
            ..good
        },
        Faults {
            delay_ms: 60_001,
            ..good
        },
        Faults {
            hold_ms: 60_001,
            ..good
        },
    ] {
        assert!(Link::new(faults, 0).is_err(), "{faults:?}");
        assert!(Link::new(good, 0).unwrap().set_faults(faults).is_err());
    }
}
