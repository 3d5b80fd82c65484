//! Chapter `gesture`: features, the two models' decisions, and what counts.

#[cfg(not(kani))]
use super::kani;
use sidestep::gesture::{
    self, Debounce, Features, Gesture, Model, Nearest, OUTPUTS, PAIRS, Point, Skeleton, Weights,
};
use sidestep_spec::gesture as law;

/// Any bit pattern as a joint, tracked or not.
fn any_joint() -> Option<Point> {
    if kani::any() {
        Some(Point::new(kani::any(), kani::any(), kani::any()))
    } else {
        None
    }
}

/// Any bit pattern as a skeleton.
pub fn any_skeleton() -> Skeleton {
    Skeleton {
        id: kani::any(),
        neck: any_joint(),
        left_shoulder: any_joint(),
        right_shoulder: any_joint(),
        left_elbow: any_joint(),
        right_elbow: any_joint(),
        left_wrist: any_joint(),
        right_wrist: any_joint(),
    }
}

/// Any features there are.
pub fn any_features() -> Features {
    let features = Features::new(kani::any(), kani::any());
    kani::assume(features.is_ok());
    match features {
        Ok(features) => features,
        Err(_) => unreachable!(),
    }
}

/// Any class.
pub fn any_gesture() -> Gesture {
    Gesture::ALL[usize::from(kani::any::<u8>()) % Gesture::COUNT]
}

/// Features exist only within their limit, whatever numbers they are made of. `Features::of` ends in
/// this constructor.
//= gesture.INV-1
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(12))]
pub fn features_are_bounded() {
    let features = Features::new(kani::any(), kani::any());
    if let Ok(features) = &features {
        assert!(law::features_in_range(
            features.six(),
            features.arms(),
            Features::LIMIT
        ));
    }
    kani::cover!(features.is_ok(), "features");
    kani::cover!(features.is_err(), "none");
}

/// A skeleton of any bit patterns is rejected unless every joint is tracked and finite.
/// `Features::of`, and so whatever recognises, begins with this.
//= gesture.INV-3
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(12))]
pub fn skeleton_is_whole_or_rejected() {
    let skeleton = any_skeleton();
    let mut whole = true;
    let joints = skeleton.joints();
    let mut i = 0;
    while i < joints.len() {
        whole &= match joints[i] {
            Some(at) => at.x.is_finite() && at.y.is_finite() && at.z.is_finite(),
            None => false,
        };
        i += 1;
    }
    let judged = skeleton.whole();
    assert!(law::whole_or_rejected(whole, judged.is_ok()));
    kani::cover!(judged.is_ok(), "whole");
    kani::cover!(whole && judged.is_err(), "whole, and nowhere near");
    kani::cover!(skeleton.right_wrist.is_none(), "the last joint is missing");
}

/// A weighted sum is finite for any weights that a model may have and any features there are, and
/// so is what a hidden neuron makes of it.
//= gesture.INV-4
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(12))]
pub fn scores_are_finite() {
    let weights: Weights = kani::any();
    let mut i = 0;
    while i < weights.len() {
        kani::assume(weights[i].abs() <= 1e6);
        i += 1;
    }
    let sum = gesture::weighted_sum(&weights, &any_features());
    assert!(law::is_score(sum));
    let activation = gesture::squashed(sum);
    assert!(law::is_score(activation) && activation.abs() <= 1.0);
    kani::cover!(sum > 1e6, "a large sum");
    kani::cover!(activation < -0.9, "a small activation");
}

/// What is accepted is the nearest class by the least margin, and no more unlike it than the
/// greatest unlikeness: for any claims of both, NaN included, with both models as trained.
//= gesture.INV-5
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn accepted_pose_is_clear() {
    let model = if kani::any() {
        Model::NEURAL_NETWORK
    } else {
        Model::SUPPORT_VECTOR_MACHINE
    };
    let nearest = Nearest {
        gesture: any_gesture(),
        margin: kani::any(),
    };
    let unlikeness = kani::any();
    let judged = model.judge(&nearest, unlikeness);
    if let Ok(gesture) = judged {
        assert!(law::is_clear(
            gesture == nearest.gesture,
            nearest.margin,
            model.margin(),
            unlikeness,
            model.unlikeness()
        ));
    }
    kani::cover!(judged.is_ok(), "accepted");
    kani::cover!(nearest.margin.is_nan(), "no margin");
    kani::cover!(nearest.margin > 1.0 && judged.is_err(), "unlike");
}

/// How unlike a class any features are is a finite number, for both models as trained.
//= gesture.INV-4
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(minisat))]
#[cfg_attr(kani, kani::unwind(12))]
pub fn unlikeness_is_finite() {
    let model = Model::NEURAL_NETWORK;
    let unlikeness = model
        .prototypes()
        .unlikeness(any_gesture(), &any_features());
    assert!(law::is_score(unlikeness) && unlikeness >= 0.0);
    kani::cover!(unlikeness > 1.0, "unlike");
}

/// The winner by a margin that is not negative beats all others, for any finite scores.
//= gesture.INV-6
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(23))]
pub fn winner_beats_all() {
    let scores: [f32; PAIRS] = kani::any();
    let mut table = [[0.0_f64; Gesture::COUNT]; Gesture::COUNT];
    let mut pair = 0;
    let mut i = 0;
    while i < Gesture::COUNT {
        let mut j = i + 1;
        while j < Gesture::COUNT {
            kani::assume(scores[pair].is_finite());
            table[i][j] = f64::from(scores[pair]);
            table[j][i] = -f64::from(scores[pair]);
            j += 1;
            pair += 1;
        }
        i += 1;
    }
    let nearest = gesture::winner(&scores);
    assert!(nearest.margin < 0.0 || law::beats_all(nearest.gesture.index(), &table, 0.0));
    kani::cover!(nearest.margin < 0.0, "nobody beats all others");
    kani::cover!(nearest.margin > 1.0, "a clear winner");
}

/// The signs of the outputs spell the class, for any outputs; no margin is larger than an output,
/// and what is not finite spells none.
//= gesture.INV-7
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(5))]
pub fn outputs_spell_the_class() {
    let outputs: [f32; OUTPUTS] = kani::any();
    let nearest = gesture::spelled_by(&outputs);
    if let Some(nearest) = nearest {
        assert!(law::is_spelled(nearest.gesture.code(), &outputs));
        let mut bit = 0;
        while bit < OUTPUTS {
            assert!(nearest.margin <= outputs[bit].abs());
            bit += 1;
        }
    }
    kani::cover!(nearest.is_none(), "the code that no class has");
    kani::cover!(
        nearest.is_some_and(|nearest| nearest.gesture == Gesture::Stop),
        "stop"
    );
}

/// One step of the count from any count whatever: if it was right before, it is right after, so it
/// is right after any number of frames.
//= gesture.INV-8
//= gesture.INV-9
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(kani, kani::unwind(5))]
pub fn gesture_counts_after_enough_frames() {
    let any_pose = || {
        if kani::any() {
            Some(any_gesture())
        } else {
            None
        }
    };
    let before = Debounce {
        pose: any_pose(),
        frames: kani::any(),
    };
    let (pose, frames): (Option<Gesture>, u32) = (any_pose(), kani::any());
    kani::assume(frames >= 1);
    let in_a_row = match pose {
        None => 0,
        Some(_) if pose == before.pose => before.frames.saturating_add(1),
        Some(_) => 1,
    };
    let after = before.after(pose);
    let gesture = after.gesture(frames);
    assert!(law::counts_after(gesture.is_some(), in_a_row, frames));
    assert!(law::lost_at_once(gesture, pose));
    kani::cover!(gesture.is_some() && frames > 1, "it counts");
    kani::cover!(
        before.gesture(frames).is_some() && gesture.is_none(),
        "lost"
    );
}
