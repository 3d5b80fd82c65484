//! Chapter `gesture`: features, the two models, and what counts. See `spec/gesture.md`.

/// The joints in order: neck, left and right shoulder, left and right elbow, left and right wrist;
/// x to the camera's left, y up, z ahead, m.
pub type Joints = [[f64; 3]; 7];

// ---------------------------------------------------------------- equations

/// S3's features as printed: "y" of the elbows and the wrists, "y, z" of the neck, in m.
#[must_use]
pub fn features_printed(joints: &Joints) -> [f64; 6] {
    let [neck, _, _, left_elbow, right_elbow, left_wrist, right_wrist] = joints;
    [
        left_elbow[1],
        right_elbow[1],
        left_wrist[1],
        right_wrist[1],
        neck[1],
        neck[2],
    ]
}

/// The features as read, in lengths of an arm: the six that a classifier gets, and the four that
/// serve to reject.
#[must_use]
pub fn features(joints: &Joints) -> ([f64; 6], [f64; 4]) {
    let [
        neck,
        left_shoulder,
        right_shoulder,
        left_elbow,
        right_elbow,
        left_wrist,
        right_wrist,
    ] = joints;
    let length = |from: &[f64; 3], to: &[f64; 3]| {
        (0..3)
            .map(|i| (to[i] - from[i]).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let arm = 0.5
        * (length(left_shoulder, left_elbow)
            + length(left_elbow, left_wrist)
            + length(right_shoulder, right_elbow)
            + length(right_elbow, right_wrist));
    // The person's own axes: to their right along the shoulders, and the way they face.
    let bearing =
        (right_shoulder[2] - left_shoulder[2]).atan2(right_shoulder[0] - left_shoulder[0]);
    let own_right = [bearing.cos(), 0.0, bearing.sin()];
    let faced = [bearing.sin(), 0.0, -bearing.cos()];
    let along = |from: &[f64; 3], to: &[f64; 3], axis: &[f64; 3]| {
        (0..3).map(|i| (to[i] - from[i]) * axis[i]).sum::<f64>() / arm
    };
    let middle = [0, 1, 2].map(|i| 0.5 * (left_shoulder[i] + right_shoulder[i]));
    let height = |joint: &[f64; 3]| (joint[1] - neck[1]) / arm;
    (
        [
            height(left_elbow),
            height(right_elbow),
            height(left_wrist),
            height(right_wrist),
            (neck[1] - middle[1]) / arm,
            along(&middle, neck, &faced),
        ],
        [
            length(left_shoulder, left_wrist) / arm,
            length(right_shoulder, right_wrist) / arm,
            -along(left_shoulder, left_wrist, &own_right),
            along(right_shoulder, right_wrist, &own_right),
        ],
    )
}

/// A weighted sum of inputs; the last weight is the constant.
fn weighted(weights: &[f64], inputs: &[f64]) -> f64 {
    let sum: f64 = weights.iter().zip(inputs).map(|(w, x)| w * x).sum();
    sum + weights[inputs.len()]
}

/// The scores of the duels of a linear support vector machine for seven classes: `scores[i][j]` is
/// positive where i beats j, and `scores[j][i]` is its negative.
#[must_use]
pub fn duels(planes: &[[f64; 7]; 21], six: &[f64; 6]) -> [[f64; 7]; 7] {
    let mut scores = [[0.0; 7]; 7];
    let pairs = (0..7).flat_map(|i| (i + 1..7).map(move |j| (i, j)));
    for ((i, j), plane) in pairs.zip(planes) {
        let score = weighted(plane, six);
        scores[i][j] = score;
        scores[j][i] = -score;
    }
    scores
}

/// The sums of the three output neurons of a net with six hidden ones.
#[must_use]
pub fn outputs(hidden: &[[f64; 7]; 6], output: &[[f64; 7]; 3], six: &[f64; 6]) -> [f64; 3] {
    let hidden = hidden.map(|weights| {
        let sum = weighted(&weights, six);
        sum / (1.0 + sum.abs())
    });
    output.map(|weights| weighted(&weights, &hidden))
}

/// How unlike a class features are: of the squared distances from the class's means, in its standard
/// deviations, the mean, or a quarter of the greatest.
#[must_use]
pub fn unlikeness(usual: &[(f64, f64)], values: &[f64]) -> f64 {
    let squares: Vec<f64> = usual
        .iter()
        .zip(values)
        .map(|((mean, spread), value)| ((value - mean) / spread).powi(2))
        .collect();
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    squares
        .iter()
        .fold(mean, |most, square| most.max(square / 4.0))
}

/// S3.T1: (average error of the folds, success rate in %).
#[must_use]
pub fn t1(total_error: f64, folds: f64, samples: f64) -> (f64, f64) {
    (total_error / folds, 100.0 * (1.0 - total_error / samples))
}

// --------------------------------------------------------------- invariants

/// gesture.INV-1: features are finite and within ±`limit`.
#[must_use]
pub fn features_in_range(six: &[f32; 6], arms: &[f32; 4], limit: f32) -> bool {
    let within = |x: &f32| x.is_finite() && x.abs() <= limit;
    six.iter().all(within) && arms.iter().all(within)
}

/// gesture.INV-2: the same pose of a larger person, elsewhere, turned, has the same features.
#[must_use]
pub fn same_features(
    (six, arms): (&[f32; 6], &[f32; 4]),
    (other_six, other_arms): (&[f32; 6], &[f32; 4]),
    tolerance: f32,
) -> bool {
    let near = |(a, b): (&f32, &f32)| (a - b).abs() <= tolerance;
    six.iter().zip(other_six).all(near) && arms.iter().zip(other_arms).all(near)
}

/// gesture.INV-3: no gesture is recognised in a skeleton that is not whole.
#[must_use]
pub fn whole_or_rejected(whole: bool, recognised: bool) -> bool {
    whole || !recognised
}

/// gesture.INV-4: a score, or an unlikeness, is finite.
#[must_use]
pub fn is_score(score: f32) -> bool {
    score.is_finite()
}

/// gesture.INV-5: what is recognised is the nearest class, by the least margin or more, and no more
/// unlike it than the greatest unlikeness.
#[must_use]
pub fn is_clear(is_nearest: bool, margin: f32, least: f32, unlikeness: f32, greatest: f32) -> bool {
    is_nearest && margin >= least && unlikeness <= greatest
}

/// gesture.INV-6: with a positive margin, the class beats every other in their duel.
#[must_use]
pub fn beats_all(class: usize, scores: &[[f64; 7]; 7], rounding: f64) -> bool {
    (0..7).all(|other| other == class || scores[class][other] >= -rounding)
}

/// gesture.INV-7: the signs of the outputs spell the class's code.
#[must_use]
pub fn is_spelled(code: usize, outputs: &[f32; 3]) -> bool {
    (0..3).all(|bit| (outputs[bit] > 0.0) == (code >> bit & 1 == 1))
}

/// gesture.INV-8: a gesture counts exactly when it has been seen in so many frames in a row.
#[must_use]
pub fn counts_after(counts: bool, in_a_row: u32, frames: u32) -> bool {
    counts == (in_a_row >= frames)
}

/// gesture.INV-9: the gesture that counts, if any, is the pose of this frame.
#[must_use]
pub fn lost_at_once<G: PartialEq>(gesture: Option<G>, pose: Option<G>) -> bool {
    gesture.is_none() || gesture == pose
}
