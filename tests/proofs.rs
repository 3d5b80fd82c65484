//! The proof harnesses without Kani: the same files compile against a stand-in and run on random
//! inputs, so that they cannot rot. This finds mistakes; only `cargo kani` proves.

use std::collections::BTreeSet;

#[path = "../proofs/mod.rs"]
mod proofs;

/// The part of Kani's interface that the harnesses use, on random values.
mod kani {
    use std::cell::RefCell;

    /// The state of the random generator (SplitMix64: seeds are explicit, runs repeat).
    struct Random(u64);

    thread_local! {
        static RANDOM: RefCell<Random> = const { RefCell::new(Random(0)) };
        static COVERED: RefCell<std::collections::BTreeSet<&'static str>> =
            const { RefCell::new(std::collections::BTreeSet::new()) };
    }

    pub fn seed(seed: u64) {
        RANDOM.with(|random| random.borrow_mut().0 = seed);
    }

    fn next() -> u64 {
        RANDOM.with(|random| {
            let state = &mut random.borrow_mut().0;
            *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = *state;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            z ^ (z >> 31)
        })
    }

    /// Values of which there is a random one.
    pub trait Arbitrary {
        fn any() -> Self;
    }

    macro_rules! arbitrary_integer {
        ($($integer:ty),+) => {$(
            impl Arbitrary for $integer {
                fn any() -> Self {
                    // Small numbers and extremes as often as any others.
                    match next() % 4 {
                        0 => next() as $integer,
                        1 => (next() % 256) as $integer,
                        2 => (next() % 8192) as $integer,
                        _ => [0, 1, <$integer>::MAX, <$integer>::MIN][(next() % 4) as usize],
                    }
                }
            }
        )+};
    }

    arbitrary_integer!(u8, u16, u32, u64, usize, i8, i16, i32, i64);

    impl Arbitrary for bool {
        fn any() -> Self {
            next().is_multiple_of(2)
        }
    }

    impl Arbitrary for f32 {
        fn any() -> Self {
            match next() % 8 {
                0 => f32::from_bits(next() as u32),
                1 => [0.0, -0.0, 1.0, f32::NAN, f32::INFINITY, f32::MIN_POSITIVE]
                    [(next() % 6) as usize],
                2 => (next() % 2_000_001) as f32 / 1000.0 - 1000.0,
                3 | 4 => (next() % 20_001) as f32 / 1000.0 - 10.0,
                _ => (next() % 2_001) as f32 / 1000.0,
            }
        }
    }

    impl<T: Arbitrary + Copy + Default, const N: usize> Arbitrary for [T; N] {
        fn any() -> Self {
            let mut values = [T::default(); N];
            for value in &mut values {
                *value = T::any();
            }
            values
        }
    }

    pub fn any<T: Arbitrary>() -> T {
        T::any()
    }

    /// Thrown where an input is outside the domain of the harness.
    pub struct Discarded;

    pub fn assume(condition: bool) {
        if !condition {
            std::panic::resume_unwind(Box::new(Discarded));
        }
    }

    pub fn note(condition: bool, name: &'static str) {
        if condition {
            COVERED.with(|covered| covered.borrow_mut().insert(name));
        }
    }

    pub fn covered() -> std::collections::BTreeSet<&'static str> {
        COVERED.with(|covered| std::mem::take(&mut *covered.borrow_mut()))
    }

    macro_rules! cover {
        ($condition:expr, $name:literal) => {
            crate::kani::note($condition, $name)
        };
    }
    pub(crate) use cover;
}

/// Every harness of a chapter, by name.
macro_rules! harnesses {
    ($($chapter:ident: $($name:ident),+;)+) => {
        &[$($((stringify!($chapter), stringify!($name), proofs::$chapter::$name as fn())),+),+]
    };
}

const HARNESSES: &[(&str, &str, fn())] = harnesses! {
    arcos: checksum_is_as_specified, frame_is_checked, written_frame_is_accepted, receiver_loses_nothing, host_frame_is_reencoded, integer_comes_back, information_is_checked, short_information_is_checked, strings_are_bounded, displacement_is_shortest, odometry_moves_by_steps, compass_is_within_conventions;
    avoid: obstacle_speed_is_clamped, lateral_speed_is_not_below_printed, times_are_times,
        turn_is_at_most_half, maneuver_turns_away, maneuver_speed_is_bounded, modes_settle,
        stop_dominates, arrival_is_not_proximity, image_direction_is_folded,
        advice_is_within_limits;
    decide: beliefs_are_on_the_simplex, updates_stay_on_the_simplex,
        only_stochastic_rows_pass, expected_losses_are_between,
        ties_go_to_the_safest, dominated_actions_are_refused, decisions_never_move, little_is_withheld,
        explained_echoes_count_at_once;
    edge: nearness_is_bounded, closeness_is_bounded, projection_is_bounded, far_is_harmless,
        blind_is_never_clear, greatest_projection_decides, steering_is_bounded,
        machine_stops_and_looks;
    gesture: features_are_bounded, skeleton_is_whole_or_rejected, scores_are_finite, accepted_pose_is_clear,
        unlikeness_is_finite, winner_beats_all,
        outputs_spell_the_class, gesture_counts_after_enough_frames;
    kinematics: wheels_are_limited, wheel_rates_are_finite;
    laser: checksum_is_as_specified, telegram_is_checked, written_telegram_is_accepted,
        values_are_ranges_or_missing, bearings_are_in_order;
    failsafe: actions_form_a_semilattice, worst_cause_is_named, latched_stop_holds, what_is_overdue_latches;
    interact: machine_keeps_its_promises, frames_are_borne_out, advice_is_within_limits;
    valley: share_is_a_share,
        order_makes_no_difference;
    monitor: bound_follows_the_commands, three_in_a_row_accuse;
    shield: limits_are_rounded_down, limits_are_rounded_up, limits_of_presets, every_cause_stops, a_stop_ends, rest_is_covered_pioneer, rest_is_covered_2012, rest_is_covered_2011,
        rest_does_not_overflow, plan_covers_command, plan_covers_motion,
        admitted_motion_stays_safe_pioneer, admitted_motion_stays_safe_still,
        admitted_motion_stays_safe_2012, admitted_motion_stays_safe_2011, fits_by_clearance,
        fits_by_age, fits_by_way,
        rest_is_always_safe, any_advice_is_limited, what_moves_was_admitted, curvature_is_kept,
        search_finds_the_greatest, worse_is_no_easier, farther_is_no_easier, turned_is_no_easier,
        turn_ends_before_contact, any_law_is_shielded, contact_time_is_sound,
        stop_set_is_monotone, plan_covers_both_ways, plan_covers_turn, clearance_is_covered, every_guard_is_asked,
        what_is_slower_has_a_reason, motion_is_covered, approach_is_covered, a_pause_gives_no_licence,
        advice_is_taken_whole, no_room_stops, contact_in_time_stops;
    view: only_ranges_are_readings, echoes_are_held, nothing_is_forgotten, any_look_is_taken_in, any_observation_is_judged, any_reading_is_followed;
};

/// Names of the harnesses in the source: functions below a `kani::proof`.
fn in_source() -> BTreeSet<(String, String)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/proofs");
    let mut found = BTreeSet::new();
    for entry in std::fs::read_dir(folder).expect("proofs/") {
        let path = entry.expect("an entry").path();
        let chapter = path
            .file_stem()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        let text = std::fs::read_to_string(&path).expect("a harness file");
        let mut proof = false;
        for line in text.lines() {
            proof |= line.contains("kani::proof");
            if let Some(rest) = line.strip_prefix("pub fn ") {
                if proof {
                    let name = rest.split('(').next().unwrap_or(rest);
                    found.insert((chapter.clone(), name.to_owned()));
                }
                proof = false;
            }
        }
    }
    found
}

#[test]
fn every_harness_is_listed() {
    let listed: BTreeSet<(String, String)> = HARNESSES
        .iter()
        .map(|(chapter, name, _)| ((*chapter).to_owned(), (*name).to_owned()))
        .collect();
    assert_eq!(listed, in_source());
}

#[test]
fn harnesses_hold_on_random_inputs() {
    // Discarded inputs unwind quietly; a failed assertion is reported once, below.
    std::panic::set_hook(Box::new(|_| {}));
    let mut failures = Vec::new();
    for (chapter, name, harness) in HARNESSES {
        let (mut ran, mut discarded) = (0_u32, 0_u32);
        // At least this many inputs inside the domain, unless it is hard to hit by chance.
        while ran < 2_000 && discarded < 400_000 {
            kani::seed(u64::from(ran) << 32 | u64::from(discarded));
            match std::panic::catch_unwind(harness) {
                Ok(()) => ran += 1,
                Err(payload) if payload.is::<kani::Discarded>() => discarded += 1,
                Err(payload) => {
                    let text = payload
                        .downcast_ref::<String>()
                        .cloned()
                        .or_else(|| {
                            payload
                                .downcast_ref::<&str>()
                                .map(|text| (*text).to_owned())
                        })
                        .unwrap_or_default();
                    failures.push(format!(
                        "{chapter}::{name}, input {ran}/{discarded}: {text}"
                    ));
                    break;
                }
            }
        }
        let covered = kani::covered();
        println!("{chapter}::{name}: {ran} inputs, {discarded} discarded, reached {covered:?}");
        if ran == 0 {
            failures.push(format!(
                "{chapter}::{name}: no input in its domain was found"
            ));
        }
    }
    let _ = std::panic::take_hook();
    assert!(failures.is_empty(), "{failures:#?}");
}
