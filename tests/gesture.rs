//! Chapter `gesture`: features, the two models, and what counts.

mod common;

use common::{any_f32, between};
use proptest::array::UniformArrayStrategy;
use proptest::prelude::*;
use proptest::sample::select;
use sidestep::gesture::{
    Classifier, Debounce, Features, Frame, Gesture, Model, NeuralNetwork, PEOPLE_MAX, Person,
    Point, Prototypes, Recognizer, Rejection, Settings, Skeleton, SupportVectorMachine, spelled_by,
};
use sidestep::quantity::Instant;
use sidestep_spec::gesture as law;
use std::f32::consts::PI;

/// Elevation and azimuth of the upper arm, then of the forearm (rad).
type Arm = [f32; 4];

/// A body in a pose, in front of a camera 1.2 m above the floor that is always right.
#[derive(Clone, Copy, Debug)]
struct Body {
    height: f32,
    left: Arm,
    right: Arm,
    /// To the camera's left and ahead of it, m.
    place: (f32, f32),
    /// Away from facing the camera, rad.
    turn: f32,
}

impl Body {
    fn joints(&self) -> [Point; 7] {
        let h = self.height;
        let at = |x: f32, y: f32, z: f32| Point::new(x * h, y * h, z * h);
        // Facing −z, the right hand at +x.
        let arm = |side: f32, arm: Arm| {
            let direction = |elevation: f32, azimuth: f32| {
                Point::new(
                    side * elevation.sin() * azimuth.sin(),
                    -elevation.cos(),
                    -elevation.sin() * azimuth.cos(),
                )
            };
            let shoulder = at(side * 0.11, 0.818, 0.0);
            let elbow = shoulder + direction(arm[0], arm[1]) * 0.186 * h;
            (
                shoulder,
                elbow,
                elbow + direction(arm[2], arm[3]) * 0.146 * h,
            )
        };
        let (left_shoulder, left_elbow, left_wrist) = arm(-1.0, self.left);
        let (right_shoulder, right_elbow, right_wrist) = arm(1.0, self.right);
        // Whoever stands aside of the axis faces the camera when turned by as much.
        let line_of_sight = self.place.0.atan2(self.place.1);
        let (sin, cos) = (self.turn + line_of_sight).sin_cos();
        let turned = |at: Point| Point::new(cos * at.x + sin * at.z, at.y, cos * at.z - sin * at.x);
        let place = Point::new(self.place.0, -1.2, self.place.1);
        [
            at(0.0, 0.87, -0.01),
            left_shoulder,
            right_shoulder,
            left_elbow,
            right_elbow,
            left_wrist,
            right_wrist,
        ]
        .map(|joint| turned(joint) + place)
    }

    fn skeleton(&self, id: u64) -> Skeleton {
        skeleton(id, self.joints().map(Some))
    }
}

fn skeleton(id: u64, joints: [Option<Point>; 7]) -> Skeleton {
    let [
        neck,
        left_shoulder,
        right_shoulder,
        left_elbow,
        right_elbow,
        left_wrist,
        right_wrist,
    ] = joints;
    Skeleton {
        id,
        neck,
        left_shoulder,
        right_shoulder,
        left_elbow,
        right_elbow,
        left_wrist,
        right_wrist,
    }
}

fn arm() -> impl Strategy<Value = Arm> {
    [0.0_f32..PI, -PI..PI, 0.0_f32..PI, -PI..PI]
}

const TURN_MAX: f32 = 40.0 * PI / 180.0;

/// S3's heights, distances and turns.
fn body() -> impl Strategy<Value = Body> {
    let place = (between(1.7, 4.0), between(-0.5, 0.5))
        .prop_map(|(range, bearing)| (range * bearing.sin(), range * bearing.cos()));
    let height = between(1.52, 1.87);
    (height, arm(), arm(), place, between(-TURN_MAX, TURN_MAX)).prop_map(
        |(height, left, right, place, turn)| Body {
            height,
            left,
            right,
            place,
            turn,
        },
    )
}

/// The poses of the chapter's table.
fn poses() -> Vec<(Gesture, Arm, Arm)> {
    let chapter = include_str!("../spec/gesture.md");
    let poses: Vec<_> = chapter
        .lines()
        .filter_map(|line| {
            let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
            let gesture = Gesture::ALL.into_iter().find(|g| g.name() == cells[0])?;
            let angles: Vec<f32> = cells[1..].iter().filter_map(|c| c.parse().ok()).collect();
            let angles: [f32; 8] = angles.try_into().ok()?;
            let [left, right] = [&angles[..4], &angles[4..]]
                .map(|arm| std::array::from_fn(|i| arm[i].to_radians()));
            Some((gesture, left, right))
        })
        .collect();
    assert_eq!(
        poses.len(),
        Gesture::COUNT,
        "the table of poses in the chapter"
    );
    poses
}

const MODELS: [(&str, Model); 2] = [
    ("net", Model::NEURAL_NETWORK),
    ("support vector machine", Model::SUPPORT_VECTOR_MACHINE),
];

/// Any features there are: mostly like somebody's.
fn features() -> impl Strategy<Value = Features> {
    let number = || between(-Features::LIMIT, Features::LIMIT);
    let any = (
        UniformArrayStrategy::<_, [f32; 6]>::new(number()),
        UniformArrayStrategy::<_, [f32; 4]>::new(number()),
    )
        .prop_map(|(six, arms)| Features::new(six, arms).expect("in range"));
    let real = body().prop_filter_map("features", |body| Features::of(&body.skeleton(1)).ok());
    prop_oneof![1 => any, 3 => real, 2 => near_a_gesture()]
}

/// A pose of the table, a little off.
fn near_a_gesture() -> impl Strategy<Value = Features> {
    let off = UniformArrayStrategy::<_, [f32; 8]>::new(-0.6_f32..0.6);
    (body(), select(poses()), off).prop_filter_map("features", |(body, (_, left, right), off)| {
        let body = Body {
            left: std::array::from_fn(|i| left[i] + off[i]),
            right: std::array::from_fn(|i| right[i] + off[4 + i]),
            ..body
        };
        Features::of(&body.skeleton(1)).ok()
    })
}

fn parts(features: &Features) -> (&[f32; 6], &[f32; 4]) {
    (features.six(), features.arms())
}

proptest! {
    #![proptest_config(common::cases(3_000))]

    //= gesture.INV-1
    //= gesture.INV-3
    #[test]
    fn any_skeleton_is_judged(
        joints in UniformArrayStrategy::<_, [Option<[f32; 3]>; 7]>::new(
            prop_oneof![
                4 => [between(-1.0, 1.0), between(-1.0, 1.0), between(1.0, 4.0)].prop_map(Some),
                1 => [any_f32(), any_f32(), any_f32()].prop_map(Some),
                1 => Just(None),
            ]
            .boxed(),
        )
    ) {
        let whole = joints.iter().all(|joint| joint.is_some_and(|at| at.iter().all(|x| x.is_finite())));
        let skeleton = skeleton(1, joints.map(|joint| joint.map(Point::from)));
        let features = Features::of(&skeleton);
        prop_assert!(law::whole_or_rejected(whole, features.is_ok()));
        if let Ok(features) = features {
            prop_assert!(law::features_in_range(features.six(), features.arms(), Features::LIMIT));
        }
        for (_, model) in MODELS {
            prop_assert!(law::whole_or_rejected(whole, model.recognize(&skeleton).is_ok()));
        }
    }

    //= gesture.INV-3
    #[test]
    fn one_bad_number_is_enough(body in body(), joint in 0..7_usize, axis in 0..4_usize, bad in
        select(&[f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e9][..]))
    {
        let mut joints = body.joints().map(Some);
        if axis == 3 {
            joints[joint] = None;
        } else if let Some(at) = &mut joints[joint] {
            at[axis] = bad;
        }
        let skeleton = skeleton(1, joints);
        for (_, model) in MODELS {
            let recognised = model.recognize(&skeleton);
            prop_assert!(law::whole_or_rejected(false, recognised.is_ok()));
            prop_assert!(
                matches!(recognised, Err(Rejection::NotTracked(_) | Rejection::OutOfRange(_)))
            );
        }
    }

    /// The reference says the same, in f64 and with angles.
    #[test]
    fn features_are_the_references(body in body()) {
        let features = Features::of(&body.skeleton(1)).expect("S3's domain");
        let joints = body.joints().map(|joint| [joint.x, joint.y, joint.z].map(f64::from));
        let (six, arms) = law::features(&joints);
        let (six, arms) = (six.map(|x| x as f32), arms.map(|x| x as f32));
        prop_assert!(law::same_features(parts(&features), (&six, &arms), 1e-4));
    }

    //= gesture.INV-2
    #[test]
    fn size_place_and_turn_do_not_matter(
        body in body(),
        height in between(1.0, 2.1),
        place in (between(1.0, 4.5), between(-0.5, 0.5)),
        turn in between(-TURN_MAX, TURN_MAX),
    ) {
        let elsewhere = Body {
            height,
            place: (place.0 * place.1.sin(), place.0 * place.1.cos()),
            turn,
            ..body
        };
        let (here, there) = (body.skeleton(1), elsewhere.skeleton(1));
        let (a, b) = (
            Features::of(&here).expect("S3's domain"),
            Features::of(&there).expect("S3's domain"),
        );
        prop_assert!(law::same_features(parts(&a), parts(&b), 1e-4));
    }

    /// Turned too far, nobody is understood.
    #[test]
    fn who_is_turned_away_is_rejected(
        body in body(),
        turn in between(60.0_f32.to_radians(), PI),
        left in any::<bool>(),
    ) {
        let away = Body { turn: if left { turn } else { -turn }, ..body };
        prop_assert!(matches!(Features::of(&away.skeleton(1)), Err(Rejection::OutOfRange(_))));
    }

    //= gesture.INV-4
    #[test]
    fn scores_are_scores(features in features()) {
        for (_, model) in MODELS {
            match model.classifier() {
                Classifier::SupportVectorMachine(machine) => {
                    let scores = machine.scores(&features);
                    prop_assert!(scores.iter().all(|score| law::is_score(*score)));
                }
                Classifier::NeuralNetwork(net) => {
                    let outputs = net.outputs(&features);
                    prop_assert!(outputs.iter().all(|output| law::is_score(*output)));
                }
            }
            for gesture in Gesture::ALL {
                let unlikeness = model.prototypes().unlikeness(gesture, &features);
                prop_assert!(law::is_score(unlikeness) && unlikeness >= 0.0);
            }
        }
    }

    //= gesture.INV-5
    #[test]
    fn what_is_recognised_is_clear(features in features()) {
        for (_, model) in MODELS {
            if let Ok(gesture) = model.classify(&features) {
                let nearest = model.nearest(&features).expect("a class");
                prop_assert!(law::is_clear(
                    nearest.gesture == gesture,
                    nearest.margin,
                    model.margin(),
                    model.prototypes().unlikeness(gesture, &features),
                    model.unlikeness(),
                ));
            }
        }
    }

    //= gesture.INV-6
    #[test]
    fn machine_is_the_references(features in features()) {
        let model = Model::SUPPORT_VECTOR_MACHINE;
        let Classifier::SupportVectorMachine(machine) = model.classifier() else {
            unreachable!()
        };
        let planes = machine.planes().map(|plane| plane.map(f64::from));
        let scores = law::duels(&planes, &features.six().map(f64::from));
        let nearest = machine.nearest(&features);
        prop_assert!(nearest.margin < 0.0 || law::beats_all(nearest.gesture.index(), &scores, 1e-4));
    }

    //= gesture.INV-7
    #[test]
    fn net_is_the_references(features in features()) {
        let model = Model::NEURAL_NETWORK;
        let Classifier::NeuralNetwork(net) = model.classifier() else {
            unreachable!()
        };
        let outputs = net.outputs(&features);
        let (hidden, output) = net.weights();
        let reference = law::outputs(
            &hidden.map(|weights| weights.map(f64::from)),
            &output.map(|weights| weights.map(f64::from)),
            &features.six().map(f64::from),
        );
        for (got, wanted) in outputs.iter().zip(reference) {
            prop_assert!((f64::from(*got) - wanted).abs() <= 1e-3 * wanted.abs().max(1.0));
        }
        if let Some(nearest) = net.nearest(&features) {
            prop_assert!(law::is_spelled(nearest.gesture.code(), &outputs));
        }
    }

    #[test]
    fn unlikeness_is_the_references(features in features()) {
        let prototypes = *Model::default().prototypes();
        for gesture in Gesture::ALL {
            let prototype = &prototypes.get()[gesture.index()];
            let usual: Vec<(f64, f64)> = prototype
                .six
                .iter()
                .chain(&prototype.arms)
                .map(|(mean, spread)| (f64::from(*mean), f64::from(*spread)))
                .collect();
            let values = features.six().iter().chain(features.arms());
            let values: Vec<f64> = values.copied().map(f64::from).collect();
            let wanted = law::unlikeness(&usual, &values);
            let got = f64::from(prototypes.unlikeness(gesture, &features));
            prop_assert!((got - wanted).abs() <= 1e-3 * wanted.max(1.0));
        }
    }

    /// The poses of the chapter, by anybody in S3's domain.
    #[test]
    fn poses_of_the_chapter_are_recognised(body in body(), pose in select(poses())) {
        let (gesture, left, right) = pose;
        let body = Body { left, right, ..body };
        for (name, model) in MODELS {
            prop_assert_eq!(model.recognize(&body.skeleton(1)), Ok(gesture), "{}", name);
        }
    }

    //= gesture.INV-8
    //= gesture.INV-9
    #[test]
    fn counting_is_counting(
        shown in proptest::collection::vec(proptest::option::weighted(0.9, 0..2_usize), 1..40),
        frames in 1..8_u32,
    ) {
        let mut debounce = Debounce::default();
        for (i, pose) in shown.iter().enumerate() {
            let pose = pose.map(|index| Gesture::ALL[index]);
            debounce = debounce.after(pose);
            let same = shown[..=i].iter().rev().map(|index| index.map(|i| Gesture::ALL[i]));
            let in_a_row = same.take_while(|before| before.is_some() && *before == pose).count();
            let gesture = debounce.gesture(frames);
            prop_assert!(law::counts_after(gesture.is_some(), in_a_row as u32, frames));
            prop_assert!(law::lost_at_once(gesture, pose));
        }
    }

    /// People come and go, change places in the frame, share a number; frames get lost, come twice
    /// or out of order.
    //= gesture.INV-8
    //= gesture.INV-9
    #[test]
    fn people_are_followed(
        steps in proptest::collection::vec(
            (
                prop_oneof![8 => Just(33_i64), 1 => 0_i64..400, 1 => Just(0), 1 => Just(-50)],
                proptest::collection::vec((0..4_u64, 0..3_usize), 0..=PEOPLE_MAX),
            ),
            1..30,
        ),
        (frames, stop_frames) in (1..6_u32).prop_flat_map(|n| (Just(n), 1..=n)),
    ) {
        let poses = poses();
        let settings = Settings { frames, stop_frames, frame_age_max: 200 };
        let mut recognizer = Recognizer::new(Model::default(), settings).expect("in range");
        let mut now = 10_000_u64;
        let mut before: Option<u64> = None;
        // What each person has shown in frames in a row, newest last.
        let mut history: Vec<(u64, Vec<Gesture>)> = Vec::new();
        for (step, shown) in steps {
            now = now.saturating_add_signed(step);
            let mut people = [None; PEOPLE_MAX];
            for (place, (id, pose)) in people.iter_mut().zip(&shown) {
                let (_, left, right) = poses[*pose];
                let body = Body { height: 1.7, left, right, place: (0.2, 2.5), turn: 0.1 };
                *place = Some(body.skeleton(*id));
            }
            let seen = recognizer.update(&Frame { taken_at: Instant(now), people });
            let in_a_row = before.is_some_and(|before| now > before && now - before <= 200);
            before = Some(now);
            if !in_a_row {
                history.clear();
            }
            let mut next = Vec::new();
            for (i, (id, pose)) in shown.iter().enumerate() {
                let unique = shown.iter().filter(|(other, _)| other == id).count() == 1;
                let pose = unique.then(|| poses[*pose].0);
                let mut past: Vec<Gesture> = history
                    .iter()
                    .find(|(other, _)| other == id)
                    .map(|(_, past)| past.clone())
                    .unwrap_or_default();
                if pose.is_none() {
                    past.clear();
                }
                past.extend(pose);
                let same = past.iter().rev().take_while(|before| Some(**before) == pose).count();
                let person: Person = seen[i].expect("who is in the frame is in the answer");
                prop_assert_eq!(person.id, *id);
                prop_assert_eq!(person.pose.ok(), pose);
                prop_assert_eq!(matches!(person.pose, Err(Rejection::NotUnique(_))), !unique);
                let needed = if pose == Some(Gesture::Stop) { stop_frames } else { frames };
                prop_assert!(law::counts_after(person.gesture.is_some(), same as u32, needed));
                prop_assert!(law::lost_at_once(person.gesture, pose));
                next.push((*id, past));
            }
            prop_assert!(seen[shown.len()..].iter().all(Option::is_none));
            history = next;
        }
    }
}

/// The features as printed change with size, place and height of the camera; those as read do not.
#[test]
fn printed_features_depend_on_height() {
    let (_, left, right) = poses()[0];
    let of = |height: f32| {
        let body = Body {
            height,
            left,
            right,
            place: (0.0, 2.0),
            turn: 0.0,
        };
        law::features_printed(
            &body
                .joints()
                .map(|joint| [joint.x, joint.y, joint.z].map(f64::from)),
        )
    };
    let (short, tall) = (of(1.52), of(1.87));
    assert!((short[0] - tall[0]).abs() > 0.1, "{short:?} {tall:?}");
}

#[test]
fn codes_are_codes() {
    for gesture in Gesture::ALL {
        assert_eq!(Gesture::spelled(gesture.code()), Some(gesture));
        assert_eq!(Gesture::ALL[gesture.index()], gesture);
    }
    let classes = (0..8).filter_map(Gesture::spelled).count();
    assert_eq!(classes, Gesture::COUNT);
    assert_eq!(Gesture::spelled(8), None);
}

/// What was generated keeps what the constructors ask for.
#[test]
fn weights_are_in_range() {
    for (_, model) in MODELS {
        let margin = match model.classifier() {
            Classifier::SupportVectorMachine(machine) => {
                SupportVectorMachine::new(*machine.planes()).expect("weights");
                Model::SVM_MARGIN
            }
            Classifier::NeuralNetwork(net) => {
                let (hidden, output) = net.weights();
                NeuralNetwork::new(*hidden, *output).expect("weights");
                Model::NET_MARGIN
            }
        };
        Prototypes::new(*model.prototypes().get()).expect("prototypes");
        assert_eq!(
            (model.margin(), model.unlikeness()),
            (margin, Model::UNLIKENESS)
        );
    }
}

/// A bit that is 0 is not set, and no margin is left.
#[test]
fn zero_spells_nothing() {
    let spelled = spelled_by(&[0.0; 3]).expect("a gesture");
    assert_eq!((spelled.gesture.code(), spelled.margin), (0, 0.0));
}

/// Each of the ten numbers may be three arm lengths, and no more, either way; what is more is named.
#[test]
fn features_that_nobody_has_are_refused_by_name() {
    let names = [&Features::NAMES[..], &Features::ARM_NAMES[..]].concat();
    let with = |i: usize, value: f32| {
        let mut numbers = [0.5; Features::COUNT + Features::ARMS];
        numbers[i] = value;
        let (six, arms) = numbers.split_at(Features::COUNT);
        let array = "as many as there are";
        Features::new(six.try_into().expect(array), arms.try_into().expect(array))
    };
    for (i, name) in names.iter().enumerate() {
        for value in [-Features::LIMIT, Features::LIMIT] {
            assert!(with(i, value).is_ok(), "{name}");
        }
        for value in [-3.001, 3.001, f32::NAN, f32::NEG_INFINITY] {
            let error = with(i, value).expect_err("beyond");
            assert_eq!((error.field, error.min, error.max), (*name, -3.0, 3.0));
        }
    }
}

#[test]
fn bad_weights_and_settings_are_refused_by_name() {
    let mut planes = [[0.0; 7]; 21];
    planes[20][6] = f32::NAN;
    assert_eq!(
        SupportVectorMachine::new(planes).unwrap_err().field,
        "weight"
    );
    let mut prototypes = *Model::default().prototypes().get();
    prototypes[3].arms[1] = (0.5, 0.0);
    let error = Prototypes::new(prototypes).unwrap_err();
    assert_eq!(error.field, Features::ARM_NAMES[1]);
    for settings in [
        Settings {
            frames: 0,
            ..Settings::default()
        },
        Settings {
            frames: 61,
            ..Settings::default()
        },
        Settings {
            stop_frames: 11,
            ..Settings::default()
        },
        Settings {
            frame_age_max: 5000,
            ..Settings::default()
        },
    ] {
        let error = Recognizer::new(Model::default(), settings).unwrap_err();
        assert!(error.field.starts_with("gesture "), "{error}");
    }
}

/// What is no gesture says why.
#[test]
fn rejections_say_why() {
    for (rejection, part) in [
        (
            Rejection::NotTracked("left hand"),
            "left hand is not tracked",
        ),
        (Rejection::NotUnique(7), "number 7"),
        (Rejection::Ambiguous, "between two"),
        (Rejection::Unlike(Gesture::Forward), "forward"),
    ] {
        let message = rejection.to_string();
        assert!(message.contains(part), "{message:?} does not say {part:?}");
    }
}

/// Joints are handed out from the neck to the wrists, left before right.
#[test]
fn joints_are_in_order() {
    let at = |x| Some(Point::new(x, 0.0, 2.0));
    let skeleton = Skeleton {
        neck: at(0.0),
        left_shoulder: at(0.1),
        right_shoulder: at(0.2),
        left_elbow: at(0.3),
        right_elbow: at(0.4),
        left_wrist: at(0.5),
        right_wrist: None,
        ..Skeleton::default()
    };
    let places = skeleton.joints().map(|joint| joint.map(|point| point.x));
    let expected = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5];
    assert_eq!(places[..6], expected.map(Some));
    assert_eq!(places[6], None);
}
