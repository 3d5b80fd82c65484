//! Trains the two models of chapter gesture and prints S3's Tables I to III for them.
//!
//! `cargo run --release -p sidestep-hw --example train_gestures -- --help`
//!
//! The support vector machine is linfa's; the net is trained here, by plain back-propagation. The
//! robot needs neither: it carries the weights (`--write src/gesture/weights.rs`).

use clap::Parser;
use linfa::dataset::DatasetBase;
use linfa::traits::Fit;
use linfa_svm::Svm;
use ndarray::{Array1, Array2};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use sidestep::gesture::{
    Classifier, Features, Gesture, HIDDEN, Model, NeuralNetwork, OUTPUTS, Point, Prototype,
    Prototypes, Rejection, Skeleton, SupportVectorMachine, Usual, Weights,
};
use sidestep_sim::skeleton::{Body, CameraErrors, HEIGHTS, Place, Pose};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Trains the gesture models, with S3's tables for them.
#[derive(Parser)]
struct Arguments {
    /// Train on skeletons of this CSV instead of generated ones (see `--export` for the columns).
    #[arg(long, value_name = "FILE")]
    data: Option<PathBuf>,
    /// Write the generated skeletons to a CSV.
    #[arg(long, value_name = "FILE")]
    export: Option<PathBuf>,
    /// People generated, of heights from 1.52 to 1.87 m; 8 of them make S3's 448 samples.
    #[arg(long, default_value_t = 8)]
    people: usize,
    /// Samples of each gesture from each of them.
    #[arg(long, default_value_t = 8)]
    samples: usize,
    /// Folds of the cross-validation, no more than people.
    #[arg(long, default_value_t = 8)]
    folds: usize,
    /// Seed of everything random.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write the weights, as the Rust that the core compiles, trained on 64 people where they are
    /// generated.
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
    /// Fail where the core carries other weights than these, by more than what machines round
    /// differently.
    #[arg(long)]
    check: bool,
}

/// One skeleton of known gesture.
#[derive(Clone, Copy)]
struct Sample {
    person: usize,
    gesture: Gesture,
    skeleton: Skeleton,
    features: Features,
}

/// S3: the least and greatest distance (m) and the farthest turned away (rad).
const DISTANCES: (f64, f64) = (1.7, 4.0);
const TURN_MAX: f64 = 40.0_f64.to_radians();
/// The angle of view to either side (S3: 70° in all).
const VIEW: f64 = 30.0_f64.to_radians();

fn any_place(rng: &mut ChaCha8Rng) -> Place {
    Place::at(
        rng.random_range(DISTANCES.0..=DISTANCES.1),
        rng.random_range(-VIEW..=VIEW),
        rng.random_range(-TURN_MAX..=TURN_MAX),
    )
}

/// `people` people of evenly spread heights show every gesture `samples` times. A frame in which a
/// joint is not tracked is taken again.
fn generate(people: usize, samples: usize, seed: u64) -> Result<Vec<Sample>, Box<dyn Error>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut set = Vec::new();
    for person in 0..people {
        let share = person as f64 / (people - 1).max(1) as f64;
        let height = HEIGHTS.0 + (HEIGHTS.1 - HEIGHTS.0) * share;
        let mut body = Body::new(height, CameraErrors::default(), rng.random())?;
        for gesture in Gesture::ALL {
            for _ in 0..samples {
                body.change_mood();
                let place = any_place(&mut rng);
                let (skeleton, features) = (0..100)
                    .find_map(|_| {
                        let skeleton = body.skeleton(person as u64, Pose::of(gesture), place);
                        Features::of(&skeleton).ok().map(|f| (skeleton, f))
                    })
                    .ok_or("a hundred frames without a whole skeleton")?;
                set.push(Sample {
                    person,
                    gesture,
                    skeleton,
                    features,
                });
            }
        }
    }
    Ok(set)
}

/// A row of a CSV: whose skeleton, what gesture, and where the joints are, in metres in the
/// camera's frame (x to its left, y up, z ahead). An empty field is a joint that is not tracked.
#[derive(Serialize, Deserialize)]
struct Row {
    person: usize,
    gesture: String,
    neck_x: Option<f32>,
    neck_y: Option<f32>,
    neck_z: Option<f32>,
    left_shoulder_x: Option<f32>,
    left_shoulder_y: Option<f32>,
    left_shoulder_z: Option<f32>,
    right_shoulder_x: Option<f32>,
    right_shoulder_y: Option<f32>,
    right_shoulder_z: Option<f32>,
    left_elbow_x: Option<f32>,
    left_elbow_y: Option<f32>,
    left_elbow_z: Option<f32>,
    right_elbow_x: Option<f32>,
    right_elbow_y: Option<f32>,
    right_elbow_z: Option<f32>,
    left_wrist_x: Option<f32>,
    left_wrist_y: Option<f32>,
    left_wrist_z: Option<f32>,
    right_wrist_x: Option<f32>,
    right_wrist_y: Option<f32>,
    right_wrist_z: Option<f32>,
}

impl Row {
    fn skeleton(&self) -> Skeleton {
        let point = |x: Option<f32>, y: Option<f32>, z: Option<f32>| Some(Point::new(x?, y?, z?));
        Skeleton {
            id: self.person as u64,
            neck: point(self.neck_x, self.neck_y, self.neck_z),
            left_shoulder: point(
                self.left_shoulder_x,
                self.left_shoulder_y,
                self.left_shoulder_z,
            ),
            right_shoulder: point(
                self.right_shoulder_x,
                self.right_shoulder_y,
                self.right_shoulder_z,
            ),
            left_elbow: point(self.left_elbow_x, self.left_elbow_y, self.left_elbow_z),
            right_elbow: point(self.right_elbow_x, self.right_elbow_y, self.right_elbow_z),
            left_wrist: point(self.left_wrist_x, self.left_wrist_y, self.left_wrist_z),
            right_wrist: point(self.right_wrist_x, self.right_wrist_y, self.right_wrist_z),
        }
    }

    fn of(sample: &Sample) -> Self {
        let s = &sample.skeleton;
        let [neck_x, neck_y, neck_z] = split(s.neck);
        let [left_shoulder_x, left_shoulder_y, left_shoulder_z] = split(s.left_shoulder);
        let [right_shoulder_x, right_shoulder_y, right_shoulder_z] = split(s.right_shoulder);
        let [left_elbow_x, left_elbow_y, left_elbow_z] = split(s.left_elbow);
        let [right_elbow_x, right_elbow_y, right_elbow_z] = split(s.right_elbow);
        let [left_wrist_x, left_wrist_y, left_wrist_z] = split(s.left_wrist);
        let [right_wrist_x, right_wrist_y, right_wrist_z] = split(s.right_wrist);
        Self {
            person: sample.person,
            gesture: sample.gesture.name().to_owned(),
            neck_x,
            neck_y,
            neck_z,
            left_shoulder_x,
            left_shoulder_y,
            left_shoulder_z,
            right_shoulder_x,
            right_shoulder_y,
            right_shoulder_z,
            left_elbow_x,
            left_elbow_y,
            left_elbow_z,
            right_elbow_x,
            right_elbow_y,
            right_elbow_z,
            left_wrist_x,
            left_wrist_y,
            left_wrist_z,
            right_wrist_x,
            right_wrist_y,
            right_wrist_z,
        }
    }
}

fn split(point: Option<Point>) -> [Option<f32>; 3] {
    point.map_or([None; 3], |p| [Some(p.x), Some(p.y), Some(p.z)])
}

/// The samples of a CSV. Rows whose skeleton has no features are counted and left out.
fn read(path: &Path) -> Result<Vec<Sample>, Box<dyn Error>> {
    let named = |error: csv::Error| format!("{}: {error}", path.display());
    let mut reader = csv::Reader::from_path(path).map_err(named)?;
    let (mut set, mut left_out) = (Vec::new(), 0);
    for (i, row) in reader.deserialize().enumerate() {
        let row: Row = row.map_err(named)?;
        let gesture = Gesture::ALL
            .into_iter()
            .find(|gesture| gesture.name() == row.gesture)
            .ok_or_else(|| {
                let names = Gesture::ALL.map(Gesture::name).join(", ");
                let (path, gesture) = (path.display(), &row.gesture);
                format!("{path}: row {}: no gesture {gesture:?}: {names}", i + 1)
            })?;
        let skeleton = row.skeleton();
        match Features::of(&skeleton) {
            Ok(features) => set.push(Sample {
                person: row.person,
                gesture,
                skeleton,
                features,
            }),
            Err(reason) => {
                left_out += 1;
                eprintln!("{}: row {}: left out: {reason}", path.display(), i + 1);
            }
        }
    }
    println!(
        "{}: {} samples, {left_out} left out",
        path.display(),
        set.len()
    );
    Ok(set)
}

fn export(path: &Path, set: &[Sample]) -> Result<(), Box<dyn Error>> {
    let mut writer = csv::Writer::from_path(path)?;
    for sample in set {
        writer.serialize(Row::of(sample))?;
    }
    writer.flush()?;
    println!("{}: {} samples", path.display(), set.len());
    Ok(())
}

fn inputs(features: &Features) -> [f64; Features::COUNT] {
    features.six().map(f64::from)
}

/// One plane for each pair of classes, and how many support vectors they have in all.
fn train_machine(
    set: &[&Sample],
    penalty: f64,
) -> Result<(SupportVectorMachine, usize), Box<dyn Error>> {
    let mut planes = Vec::new();
    let mut support_vectors = 0;
    for (i, first) in Gesture::ALL.into_iter().enumerate() {
        for second in &Gesture::ALL[i + 1..] {
            let pair: Vec<&&Sample> = set
                .iter()
                .filter(|sample| sample.gesture == first || sample.gesture == *second)
                .collect();
            let records = Array2::from_shape_fn((pair.len(), Features::COUNT), |(row, column)| {
                inputs(&pair[row].features)[column]
            });
            let targets = Array1::from_iter(pair.iter().map(|sample| sample.gesture == first));
            let machine = Svm::<f64, bool>::params()
                .pos_neg_weights(penalty, penalty)
                .eps(1e-3)
                .linear_kernel()
                .fit(&DatasetBase::new(records, targets))?;
            support_vectors += machine.nsupport();
            // The plane's weights, by asking for the sum at each unit vector.
            let mut plane: Weights = [0.0; Features::COUNT + 1];
            for (column, weight) in plane.iter_mut().take(Features::COUNT).enumerate() {
                let mut unit = Array1::zeros(Features::COUNT);
                unit[column] = 1.0;
                *weight = machine.weighted_sum(&unit) as f32;
            }
            plane[Features::COUNT] = -machine.rho as f32;
            planes.push(plane);
        }
    }
    let planes = planes.try_into().map_err(|_| "not 21 planes")?;
    Ok((SupportVectorMachine::new(planes)?, support_vectors))
}

/// A net in training, with any number of hidden neurons. The last weight of a neuron is the
/// constant.
struct Net {
    hidden: Vec<[f64; Features::COUNT + 1]>,
    output: Vec<Vec<f64>>,
}

/// S3's learning rate.
const LEARNING_RATE: f64 = 0.15;
/// What an output neuron is to give for a bit that is 1; for 0 it is the negative.
const TARGET: f64 = 0.8;
/// How often each sample is learnt from. Many more make the net fit single outliers.
const ROUNDS: usize = 100;

fn squash(x: f64) -> f64 {
    x / (1.0 + x.abs())
}

/// The slope of [`squash`] where it gives `y`.
fn slope(y: f64) -> f64 {
    (1.0 - y.abs()).powi(2)
}

fn target(gesture: Gesture, output: usize) -> f64 {
    if gesture.code() >> output & 1 == 1 {
        TARGET
    } else {
        -TARGET
    }
}

impl Net {
    fn sums(&self, inputs: &[f64; Features::COUNT]) -> (Vec<f64>, Vec<f64>) {
        let hidden: Vec<f64> = self
            .hidden
            .iter()
            .map(|weights| {
                let sum: f64 = weights.iter().zip(inputs).map(|(w, x)| w * x).sum();
                squash(sum + weights[Features::COUNT])
            })
            .collect();
        let outputs = self
            .output
            .iter()
            .map(|weights| {
                let sum: f64 = weights.iter().zip(&hidden).map(|(w, x)| w * x).sum();
                sum + weights[hidden.len()]
            })
            .collect();
        (hidden, outputs)
    }

    fn nearest(&self, features: &Features) -> Option<Gesture> {
        let (_, outputs) = self.sums(&inputs(features));
        let code = (0..OUTPUTS).map(|o| usize::from(outputs[o] > 0.0) << o);
        Gesture::spelled(code.sum())
    }

    /// Back-propagation, one sample after the other.
    fn train(set: &[&Sample], hidden: usize, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut weight = || rng.random_range(-0.5..=0.5);
        let mut net = Self {
            hidden: (0..hidden)
                .map(|_| core::array::from_fn(|_| weight()))
                .collect(),
            output: (0..OUTPUTS)
                .map(|_| (0..=hidden).map(|_| weight()).collect())
                .collect(),
        };
        let mut order: Vec<usize> = (0..set.len()).collect();
        for _ in 0..ROUNDS {
            order.shuffle(&mut rng);
            for &i in &order {
                net.learn(set[i]);
            }
        }
        net
    }

    /// One step down the squared error of one sample.
    fn learn(&mut self, sample: &Sample) {
        let inputs = inputs(&sample.features);
        let (hidden, sums) = self.sums(&inputs);
        let mut blame = vec![0.0; hidden.len()];
        for (o, sum) in sums.iter().enumerate() {
            let given = squash(*sum);
            let error = target(sample.gesture, o) - given;
            let delta = error * slope(given);
            for (i, value) in hidden.iter().enumerate() {
                blame[i] += delta * self.output[o][i];
                self.output[o][i] += LEARNING_RATE * delta * value;
            }
            self.output[o][hidden.len()] += LEARNING_RATE * delta;
        }
        for (i, value) in hidden.iter().enumerate() {
            let delta = blame[i] * slope(*value);
            for (weight, input) in self.hidden[i].iter_mut().zip(&inputs) {
                *weight += LEARNING_RATE * delta * input;
            }
            self.hidden[i][Features::COUNT] += LEARNING_RATE * delta;
        }
    }

    /// The net as the robot computes it.
    fn single(&self) -> Result<NeuralNetwork, Box<dyn Error>> {
        let hidden: Vec<Weights> = self
            .hidden
            .iter()
            .map(|weights| weights.map(|w| w as f32))
            .collect();
        let output: Vec<[f32; HIDDEN + 1]> = self
            .output
            .iter()
            .map(|weights| core::array::from_fn(|i| weights[i] as f32))
            .collect();
        Ok(NeuralNetwork::new(
            hidden.try_into().map_err(|_| "not six hidden neurons")?,
            output.try_into().map_err(|_| "not three outputs")?,
        )?)
    }
}

/// How each class usually is.
fn prototypes(set: &[&Sample]) -> [Prototype; Gesture::COUNT] {
    Gesture::ALL.map(|gesture| {
        let of_class = |feature: &dyn Fn(&Features) -> f32| {
            let values: Vec<f64> = set
                .iter()
                .filter(|sample| sample.gesture == gesture)
                .map(|sample| f64::from(feature(&sample.features)))
                .collect();
            usual(&values)
        };
        Prototype {
            six: core::array::from_fn(|i| of_class(&|features| features.six()[i])),
            arms: core::array::from_fn(|i| of_class(&|features| features.arms()[i])),
        }
    })
}

fn usual(values: &[f64]) -> Usual {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    // To the ten-thousandth of an arm: nobody reads more.
    let round = |x: f64| ((x * 10_000.0).round() / 10_000.0) as f32;
    (round(mean), round(variance.sqrt()))
}

/// What to train on, and what to test on.
type Fold<'a> = (Vec<&'a Sample>, Vec<&'a Sample>);

/// Splits by person.
fn folds(set: &[Sample], count: usize) -> Result<Vec<Fold<'_>>, String> {
    let mut people: Vec<usize> = set.iter().map(|sample| sample.person).collect();
    people.sort_unstable();
    people.dedup();
    if count < 2 || people.len() < count {
        return Err(format!(
            "--folds is {count}, allowed is 2 to the number of people, {}",
            people.len()
        ));
    }
    Ok((0..count)
        .map(|fold| {
            set.iter().partition(|sample| {
                let place = people.iter().position(|person| *person == sample.person);
                place.is_some_and(|place| place % count != fold)
            })
        })
        .collect())
}

/// S3 Table I: n of C = eⁿ.
const PENALTIES: [i32; 14] = [-10, -5, -4, -3, -2, -1, 0, 1, 2, 3, 5, 10, 30, 69];

fn milliseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1000.0
}

/// Prints Table I; gives the best C and its success rate. Of equals it is the one with the fewest
/// support vectors, so that hardly a sample lies within the margin by which a duel has to be won.
fn table_1(set: &[Sample], count: usize) -> Result<(f64, f64), Box<dyn Error>> {
    println!(
        "\nTable I: the support vector machine, {} samples, {count} folds by person",
        set.len()
    );
    println!(
        "| C | total error | average error | success rate (%) | train (ms) | test (ms) | support vectors |"
    );
    println!("|---|---|---|---|---|---|---|");
    let folds = folds(set, count)?;
    let mut best: Option<(usize, usize, f64)> = None;
    for n in PENALTIES {
        let penalty = f64::from(n).exp();
        let (mut errors, mut train, mut test, mut vectors) = (0, 0.0, 0.0, 0);
        for (training, testing) in &folds {
            let begin = Instant::now();
            let (machine, support) = train_machine(training, penalty)?;
            train += milliseconds(begin);
            vectors += support;
            let begin = Instant::now();
            errors += testing
                .iter()
                .filter(|sample| machine.nearest(&sample.features).gesture != sample.gesture)
                .count();
            test += milliseconds(begin);
        }
        println!(
            "| e^{n} = {penalty:.4e} | {errors} | {:.3} | {:.2} | {:.1} | {:.2} | {} |",
            errors as f64 / count as f64,
            success(errors, set.len()),
            train / count as f64,
            test / count as f64,
            vectors / count
        );
        if best.is_none_or(|(least, fewest, _)| (errors, vectors) < (least, fewest)) {
            best = Some((errors, vectors, penalty));
        }
    }
    let (errors, _, penalty) = best.ok_or("no C")?;
    println!("least errors, with the fewest support vectors, at C = {penalty:.4}: {errors}");
    Ok((penalty, success(errors, set.len())))
}

fn success(errors: usize, samples: usize) -> f64 {
    100.0 * (1.0 - errors as f64 / samples as f64)
}

/// Prints Table II; gives the errors with S3's six neurons.
fn table_2(set: &[Sample], count: usize, seed: u64) -> Result<usize, Box<dyn Error>> {
    println!(
        "\nTable II: the net, {} samples, {count} folds by person",
        set.len()
    );
    println!("| hidden neurons | errors | train (ms) | test (ms) |");
    println!("|---|---|---|---|");
    let folds = folds(set, count)?;
    let mut chosen = 0;
    for hidden in 3..=15 {
        let (mut errors, mut train, mut test) = (0, 0.0, 0.0);
        for (training, testing) in &folds {
            let begin = Instant::now();
            let net = Net::train(training, hidden, seed);
            train += milliseconds(begin);
            let begin = Instant::now();
            errors += testing
                .iter()
                .filter(|sample| net.nearest(&sample.features) != Some(sample.gesture))
                .count();
            test += milliseconds(begin);
        }
        println!(
            "| {hidden} | {errors} | {:.1} | {:.2} |",
            train / count as f64,
            test / count as f64
        );
        if hidden == HIDDEN {
            chosen = errors;
        }
    }
    Ok(chosen)
}

/// S3 Table III: the people's heights (m).
const TABLE_3: [f64; 5] = [1.65, 1.70, 1.77, 1.79, 1.81];

/// Prints Table III: people who were not trained on, three of each order, a frame each.
fn table_3(models: &[(&str, Model)], seed: u64) -> Result<(), Box<dyn Error>> {
    println!("\nTable III: five new people, 18 gestures each (the six orders, three times)");
    println!(
        "| model | person | experiments | height (cm) | false | rejected | joint not tracked |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (name, model) in models {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        for (person, height) in TABLE_3.into_iter().enumerate() {
            let mut body = Body::new(height, CameraErrors::default(), rng.random())?;
            let (mut wrong, mut rejected, mut lost) = (0, 0, 0);
            for gesture in &Gesture::ALL[1..] {
                for _ in 0..3 {
                    body.change_mood();
                    let place = any_place(&mut rng);
                    match model.recognize(&body.skeleton(1, Pose::of(*gesture), place)) {
                        Ok(seen) if seen == *gesture => {}
                        Ok(_) => wrong += 1,
                        Err(Rejection::NotTracked(_)) => lost += 1,
                        Err(_) => rejected += 1,
                    }
                }
            }
            println!(
                "| {name} | {} | 18 | {:.0} | {wrong} | {rejected} | {lost} |",
                person + 1,
                height * 100.0
            );
        }
    }
    Ok(())
}

/// Prints what new people's gestures are taken for, frame by frame; gives the share that is right (%).
fn confusion(name: &str, model: &Model, people: u64, seed: u64) -> Result<f64, Box<dyn Error>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut counts = [[0_u32; Gesture::COUNT + 2]; Gesture::COUNT];
    for _ in 0..people {
        let mut body = Body::any(CameraErrors::default(), rng.random())?;
        for gesture in Gesture::ALL {
            for _ in 0..8 {
                body.change_mood();
                let place = any_place(&mut rng);
                let seen = model.recognize(&body.skeleton(1, Pose::of(gesture), place));
                let column = match seen {
                    Ok(seen) => seen.index(),
                    Err(Rejection::NotTracked(_)) => Gesture::COUNT + 1,
                    Err(_) => Gesture::COUNT,
                };
                counts[gesture.index()][column] += 1;
            }
        }
    }
    println!(
        "\nConfusion of the {name}: frames of {people} new people, shown in rows, seen in columns"
    );
    println!(
        "| shown | {} | rejected | joint not tracked |",
        Gesture::ALL.map(Gesture::name).join(" | ")
    );
    println!("|---{}|", "|---".repeat(Gesture::COUNT + 2));
    for gesture in Gesture::ALL {
        let row: Vec<String> = counts[gesture.index()].iter().map(u32::to_string).collect();
        println!("| {gesture} | {} |", row.join(" | "));
    }
    let whole: u32 = counts
        .iter()
        .map(|row| row[..=Gesture::COUNT].iter().sum::<u32>())
        .sum();
    let right: u32 = (0..Gesture::COUNT).map(|i| counts[i][i]).sum();
    let rejected: u32 = counts.iter().map(|row| row[Gesture::COUNT]).sum();
    let share = |part: u32| 100.0 * f64::from(part) / f64::from(whole);
    println!(
        "of {whole} whole skeletons: right {:.2} %, rejected {:.2} %, wrong {:.3} %",
        share(right),
        share(rejected),
        share(whole - right - rejected)
    );
    Ok(share(right))
}

/// Prints how unlike their own class frames of new people are: what the limit of unlikeness is for.
fn likeness(model: &Model, people: u64, seed: u64) -> Result<(), Box<dyn Error>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    println!("\nUnlikeness of frames of {people} new people to their own class");
    println!("| gesture | median | 99 % | 99.9 % | greatest |");
    println!("|---|---|---|---|---|");
    let mut values: Vec<Vec<f32>> = vec![Vec::new(); Gesture::COUNT];
    for _ in 0..people {
        let mut body = Body::any(CameraErrors::default(), rng.random())?;
        for gesture in Gesture::ALL {
            for _ in 0..8 {
                body.change_mood();
                let place = any_place(&mut rng);
                if let Ok(features) = Features::of(&body.skeleton(1, Pose::of(gesture), place)) {
                    let unlikeness = model.prototypes().unlikeness(gesture, &features);
                    values[gesture.index()].push(unlikeness);
                }
            }
        }
    }
    for gesture in Gesture::ALL {
        let values = &mut values[gesture.index()];
        values.sort_by(f32::total_cmp);
        let at = |share: f64| values[((values.len() - 1) as f64 * share) as usize];
        println!(
            "| {gesture} | {:.2} | {:.2} | {:.2} | {:.2} |",
            at(0.5),
            at(0.99),
            at(0.999),
            at(1.0)
        );
    }
    Ok(())
}

/// What a pose that is no gesture is taken for: shares of the frames, in per cent.
#[derive(Clone, Copy, Default)]
struct Taken {
    rejected: f64,
    rest_or_stop: f64,
    other: f64,
}

impl Taken {
    fn cells(self) -> String {
        let Self {
            rejected,
            rest_or_stop,
            other,
        } = self;
        format!(" {rejected:.2} | {rest_or_stop:.2} | {other:.2} |")
    }
}

fn judge(
    model: &Model,
    people: u64,
    seed: u64,
    mut pose: impl FnMut(&mut ChaCha8Rng) -> Pose,
) -> Result<Taken, Box<dyn Error>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut taken = Taken::default();
    for _ in 0..people {
        let mut body = Body::any(CameraErrors::default(), rng.random())?;
        for _ in 0..8 {
            body.change_mood();
            let pose = pose(&mut rng);
            let place = any_place(&mut rng);
            match model.recognize(&body.skeleton(1, pose, place)) {
                Err(Rejection::NotTracked(_)) => {}
                Err(_) => taken.rejected += 1.0,
                Ok(Gesture::Rest | Gesture::Stop) => taken.rest_or_stop += 1.0,
                Ok(_) => taken.other += 1.0,
            }
        }
    }
    let share = 100.0 / (taken.rejected + taken.rest_or_stop + taken.other);
    Ok(Taken {
        rejected: taken.rejected * share,
        rest_or_stop: taken.rest_or_stop * share,
        other: taken.other * share,
    })
}

/// A pose counts as outside the classes if a part of an arm is at least this much higher or lower
/// than in every gesture (rad).
const OUTSIDE: f64 = 35.0_f64.to_radians();

fn outside(rng: &mut ChaCha8Rng) -> Pose {
    loop {
        let pose = Pose::any(rng);
        if Gesture::ALL
            .iter()
            .all(|gesture| pose.difference(Pose::of(*gesture)) >= OUTSIDE)
        {
            return pose;
        }
    }
}

/// Prints how poses that are no gesture are rejected.
fn rejections(models: &[(&str, Model)], people: u64, seed: u64) -> Result<(), Box<dyn Error>> {
    println!("\nPoses outside the seven classes, frames of {people} new people, %");
    let columns: Vec<String> = models
        .iter()
        .map(|(name, _)| format!("{name}: rejected | as rest or stop | as another order"))
        .collect();
    println!("| pose | {} |", columns.join(" | "));
    println!("|---{}|", "|---".repeat(3 * models.len()));
    let mut sums = vec![Taken::default(); models.len()];
    let part = 1.0 / Pose::OTHERS.len() as f64;
    for (name, pose) in Pose::OTHERS {
        let mut line = format!("| {name} |");
        for ((_, model), sum) in models.iter().zip(&mut sums) {
            let taken = judge(model, people, seed, |_| *pose)?;
            sum.rejected += part * taken.rejected;
            sum.rest_or_stop += part * taken.rest_or_stop;
            sum.other += part * taken.other;
            line += &taken.cells();
        }
        println!("{line}");
    }
    let cells: Vec<String> = sums.iter().map(|sum| sum.cells()).collect();
    println!("| all of these |{}", cells.concat());
    let mut line = format!(
        "| any pose, {:.0}° or more from every gesture |",
        OUTSIDE.to_degrees()
    );
    for (_, model) in models {
        line += &judge(model, 4 * people, seed, outside)?.cells();
    }
    println!("{line}");
    Ok(())
}

/// The weights as Rust.
fn source(
    from: &str,
    machine: &[Weights],
    net: &Net,
    prototypes: &[Prototype; Gesture::COUNT],
) -> String {
    let row = |weights: &[f32]| {
        let numbers: Vec<String> = weights.iter().map(|w| format!("{w:?}")).collect();
        format!("[{}],\n", numbers.join(", "))
    };
    let mut text = format!(
        "//! Weights of both models and prototypes of the classes. Generated: do not edit.\n//!\n\
         //! `cargo run --release -p sidestep-hw --example train_gestures -- --write FILE`\n\
         //! from {from}.\n\n\
         use super::{{NeuralNetwork, Prototype, Prototypes, SupportVectorMachine}};\n\n\
         /// One plane for each pair of classes.\n\
         pub(super) const SUPPORT_VECTOR_MACHINE: SupportVectorMachine = SupportVectorMachine {{\nplanes: [\n"
    );
    for plane in machine {
        text += &row(plane);
    }
    text += "],\n};\n\n/// Six hidden neurons, three outputs.\n\
             pub(super) const NEURAL_NETWORK: NeuralNetwork = NeuralNetwork {\nhidden: [\n";
    for neuron in &net.hidden {
        text += &row(&neuron.map(|w| w as f32));
    }
    text += "],\noutput: [\n";
    for neuron in &net.output {
        text += &row(&neuron.iter().map(|w| *w as f32).collect::<Vec<_>>());
    }
    text += "],\n};\n\n/// How each class usually is: mean and standard deviation of each feature.\n\
             pub(super) const PROTOTYPES: Prototypes = Prototypes([\n";
    for Prototype { six, arms } in prototypes {
        text += &format!("Prototype {{ six: {six:?}, arms: {arms:?} }},\n");
    }
    text + "]);\n"
}

/// Every number of a model, one after the other.
fn numbers(model: &Model) -> Vec<f32> {
    let mut numbers = match model.classifier() {
        Classifier::SupportVectorMachine(machine) => machine.planes().concat(),
        Classifier::NeuralNetwork(net) => {
            let (hidden, output) = net.weights();
            [hidden.concat(), output.concat()].concat()
        }
    };
    for Prototype { six, arms } in model.prototypes().get() {
        numbers.extend(
            six.iter()
                .chain(arms)
                .flat_map(|(mean, spread)| [*mean, *spread]),
        );
    }
    numbers
}

/// What two machines may round differently.
const ROUNDING: f32 = 1e-3;

/// The core carries this model, and no other.
fn check(name: &str, trained: &Model, carried: &Model) -> Result<(), String> {
    let [trained, carried] = [trained, carried].map(numbers);
    let pairs = trained.iter().zip(&carried).enumerate();
    for (i, (trained, carried)) in pairs {
        if (trained - carried).abs() > ROUNDING * trained.abs().max(1.0) {
            return Err(format!(
                "{name}: number {i} is {trained} as trained, the core has {carried}: --write \
                 src/gesture/weights.rs"
            ));
        }
    }
    println!("{name}: the core has these {} numbers", trained.len());
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let generated = arguments.data.is_none();
    let set = match &arguments.data {
        Some(path) => read(path)?,
        None => generate(arguments.people, arguments.samples, arguments.seed)?,
    };
    if let Some(path) = &arguments.export {
        export(path, &set)?;
    }
    let (penalty, machine_success) = table_1(&set, arguments.folds)?;
    let net_errors = table_2(&set, arguments.folds, arguments.seed)?;

    // What the robot carries learns from as many people as there are.
    let (full, from) = if generated {
        (
            generate(64, arguments.samples, arguments.seed + 1)?,
            format!(
                "64 generated people, {} samples of each gesture from each, seed {}",
                arguments.samples, arguments.seed
            ),
        )
    } else {
        (set, "skeletons of a CSV".to_owned())
    };
    let all: Vec<&Sample> = full.iter().collect();
    let (machine, _) = train_machine(&all, penalty)?;
    let net = Net::train(&all, HIDDEN, arguments.seed);
    let usual = prototypes(&all);
    let prototypes = Prototypes::new(usual)?;
    let models = [
        (
            "support vector machine",
            Model::new(
                Classifier::SupportVectorMachine(machine),
                Model::SVM_MARGIN,
                Model::UNLIKENESS,
                prototypes,
            )?,
        ),
        (
            "net",
            Model::new(
                Classifier::NeuralNetwork(net.single()?),
                Model::NET_MARGIN,
                Model::UNLIKENESS,
                prototypes,
            )?,
        ),
    ];
    println!("\nFrom here on: trained on {from}");
    table_3(&models, arguments.seed + 2)?;
    let mut worst: f64 = 100.0;
    for (name, model) in &models {
        worst = worst.min(confusion(name, model, 500, arguments.seed + 3)?);
    }
    likeness(&models[1].1, 500, arguments.seed + 3)?;
    rejections(&models, 100, arguments.seed + 4)?;
    if let Some(path) = &arguments.write {
        std::fs::write(path, source(&from, machine.planes(), &net, &usual))?;
        println!("\nwrote {}: run cargo fmt", path.display());
    }
    if arguments.check {
        let carried = [Model::SUPPORT_VECTOR_MACHINE, Model::NEURAL_NETWORK];
        for ((name, model), carried) in models.iter().zip(&carried) {
            check(name, model, carried)?;
        }
    }
    // S3 reports 98.2 % and no error. What is carried has to do as well with new people, though it
    // may reject a pose.
    if generated && (machine_success < 98.2 || net_errors > 0 || worst < 98.2) {
        return Err(format!(
            "S3 has 98.2 % and 0 errors, here it is {machine_success:.2} % and {net_errors}; of new \
             people {worst:.2} % are right"
        )
        .into());
    }
    Ok(())
}
