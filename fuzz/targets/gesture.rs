//! Bytes as skeletons, features, scores, and people over time.

use super::bytes::Bytes;
use sidestep::gesture::{
    self, Debounce, Features, Frame, Gesture, Model, PAIRS, PEOPLE_MAX, Point, Recognizer,
    Settings, Skeleton, Weights,
};
use sidestep::quantity::Instant;
use sidestep_spec::gesture as law;

/// Frames that a recogniser is shown at most.
const FRAMES: usize = 64;

/// Calls everything. See the module.
///
/// # Panics
/// If a predicate of the law book is broken.
pub fn run(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    match bytes.u8() % 4 {
        0 => skeletons(&mut bytes),
        1 => scores(&mut bytes),
        2 => claims(&mut bytes),
        _ => people(&mut bytes),
    }
}

fn joint(bytes: &mut Bytes) -> Option<Point> {
    (bytes.u8() > 4).then(|| Point::new(bytes.number(), bytes.number(), bytes.number().abs()))
}

fn skeleton(bytes: &mut Bytes) -> Skeleton {
    // Mostly a body at arm's length of the truth, so that features come of it.
    let mut skeleton = Skeleton {
        id: u64::from(bytes.u8() % 8),
        ..Skeleton::default()
    };
    let usual = [
        [0.0, 0.3, 2.4],
        [-0.18, 0.2, 2.4],
        [0.18, 0.2, 2.4],
        [-0.2, -0.1, 2.4],
        [0.2, -0.1, 2.4],
        [-0.2, -0.35, 2.4],
        [0.2, -0.35, 2.4],
    ];
    let plain = bytes.u8();
    let mut joints = [None; 7];
    for (i, (joint_, at)) in joints.iter_mut().zip(usual).enumerate() {
        *joint_ = if plain >> i & 1 == 0 {
            let mut off = || f32::from(bytes.u8() as i8) / 100.0;
            Some(Point::new(at[0] + off(), at[1] + off(), at[2] + off()))
        } else {
            joint(bytes)
        };
    }
    [
        skeleton.neck,
        skeleton.left_shoulder,
        skeleton.right_shoulder,
        skeleton.left_elbow,
        skeleton.right_elbow,
        skeleton.left_wrist,
        skeleton.right_wrist,
    ] = joints;
    skeleton
}

fn model(bytes: &mut Bytes) -> Model {
    if bytes.truth() {
        Model::NEURAL_NETWORK
    } else {
        Model::SUPPORT_VECTOR_MACHINE
    }
}

fn skeletons(bytes: &mut Bytes) {
    while !bytes.is_empty() {
        let model = model(bytes);
        let skeleton = skeleton(bytes);
        let whole = skeleton
            .joints()
            .iter()
            .all(|joint| joint.is_some_and(|at| at.iter().all(|x| x.is_finite())));
        let features = Features::of(&skeleton);
        let recognised = model.recognize(&skeleton);
        assert!(law::whole_or_rejected(whole, features.is_ok()));
        assert!(law::whole_or_rejected(whole, recognised.is_ok()));
        let Ok(features) = features else {
            assert!(recognised.is_err());
            continue;
        };
        assert!(law::features_in_range(
            features.six(),
            features.arms(),
            Features::LIMIT
        ));
        judged(&model, &features);
    }
}

fn judged(model: &Model, features: &Features) {
    let nearest = model.nearest(features);
    if let Some(nearest) = nearest {
        assert!(law::is_score(nearest.margin));
    }
    if let Ok(gesture) = model.classify(features) {
        let nearest = nearest.expect("what is recognised is nearest");
        assert!(law::is_clear(
            nearest.gesture == gesture,
            nearest.margin,
            model.margin(),
            model.prototypes().unlikeness(gesture, features),
            model.unlikeness()
        ));
    }
}

fn scores(bytes: &mut Bytes) {
    let model = model(bytes);
    let six = std::array::from_fn(|_| bytes.number());
    let arms = std::array::from_fn(|_| bytes.number());
    let Ok(features) = Features::new(six, arms) else {
        return;
    };
    judged(&model, &features);
    let weights: Weights = std::array::from_fn(|_| bytes.number());
    if weights.iter().all(|weight| weight.abs() <= 1e6) {
        let sum = gesture::weighted_sum(&weights, &features);
        assert!(law::is_score(sum));
        assert!(law::is_score(gesture::squashed(sum)));
    }
}

fn claims(bytes: &mut Bytes) {
    let outputs = std::array::from_fn(|_| bytes.number());
    if let Some(nearest) = gesture::spelled_by(&outputs) {
        assert!(law::is_spelled(nearest.gesture.code(), &outputs));
    }
    let scores: [f32; PAIRS] = std::array::from_fn(|_| bytes.number());
    if scores.iter().all(|score| score.is_finite()) {
        let mut table = [[0.0; Gesture::COUNT]; Gesture::COUNT];
        let pairs = (0..Gesture::COUNT).flat_map(|i| (i + 1..Gesture::COUNT).map(move |j| (i, j)));
        for ((i, j), score) in pairs.zip(&scores) {
            let score = f64::from(*score);
            (table[i][j], table[j][i]) = (score, -score);
        }
        let nearest = gesture::winner(&scores);
        assert!(nearest.margin < 0.0 || law::beats_all(nearest.gesture.index(), &table, 0.0));
    }
    let (mut debounce, frames) = (Debounce::default(), u32::from(bytes.u8() % 8) + 1);
    let mut in_a_row = 0;
    while !bytes.is_empty() {
        let pose = Gesture::spelled(usize::from(bytes.u8() % 10));
        in_a_row = match pose {
            None => 0,
            Some(_) if pose == debounce.pose => in_a_row + 1,
            Some(_) => 1,
        };
        debounce = debounce.after(pose);
        let gesture = debounce.gesture(frames);
        assert!(law::counts_after(gesture.is_some(), in_a_row, frames));
        assert!(law::lost_at_once(gesture, pose));
    }
}

fn people(bytes: &mut Bytes) {
    let settings = Settings {
        frames: u32::from(bytes.u8() % 64),
        stop_frames: u32::from(bytes.u8() % 64),
        frame_age_max: u64::from(bytes.u16()),
    };
    let Ok(mut recognizer) = Recognizer::new(model(bytes), settings) else {
        return;
    };
    let mut now = 1_000_u64;
    for _ in 0..FRAMES {
        if bytes.is_empty() {
            return;
        }
        now = now.saturating_add_signed(i64::from(bytes.u8() as i8));
        let mut people = [None; PEOPLE_MAX];
        let present = bytes.u8();
        for (i, place) in people.iter_mut().enumerate() {
            *place = (present >> i & 1 == 1).then(|| skeleton(bytes));
        }
        let frame = Frame {
            taken_at: Instant(now),
            people,
        };
        let seen = recognizer.update(&frame);
        for (person, skeleton) in seen.iter().zip(&frame.people) {
            assert_eq!(person.map(|p| p.id), skeleton.map(|s| s.id));
            if let Some(person) = person {
                assert!(law::lost_at_once(person.gesture, person.pose.ok()));
            }
        }
    }
}
