//! Residuals, starts and published minima of the problems. x₁ of the paper is `x[0]`.

use nalgebra::Complex;

/// Derivatives come by complex steps, exact to rounding: residuals are written for complex numbers.
pub(crate) type C = Complex<f64>;

/// One problem from one start.
#[derive(Debug)]
pub(crate) struct Problem {
    pub(crate) name: &'static str,
    pub(crate) start: Vec<f64>,
    pub(crate) residuals: fn(&[C]) -> Vec<C>,
    /// The sums of squares that the paper gives for the problem's minima at finite points.
    pub(crate) minima: &'static [f64],
}

fn problem(
    name: &'static str,
    start: impl Into<Vec<f64>>,
    residuals: fn(&[C]) -> Vec<C>,
    minima: &'static [f64],
) -> Problem {
    Problem { name, start: start.into(), residuals, minima }
}

const OSBORNE_2_START: [f64; 11] = [1.3, 0.65, 0.65, 0.7, 0.6, 3.0, 5.0, 7.0, 2.0, 4.5, 5.5];

/// All problems; *far* begins ten times as far off.
pub(crate) fn all() -> Vec<Problem> {
    vec![
        problem("rosenbrock", [-1.2, 1.0], rosenbrock, &[0.0]),
        problem("rosenbrock, far", [-12.0, 10.0], rosenbrock, &[0.0]),
        problem("rosenbrock, from (-1.5, 1)", [-1.5, 1.0], rosenbrock, &[0.0]),
        problem("freudenstein and roth", [0.5, -2.0], freudenstein_roth, &[0.0, 48.9842]),
        problem("freudenstein and roth, far", [5.0, -20.0], freudenstein_roth, &[0.0, 48.9842]),
        problem("powell badly scaled", [0.0, 1.0], powell_badly_scaled, &[0.0]),
        problem("brown badly scaled", [1.0, 1.0], brown_badly_scaled, &[0.0]),
        problem("beale", [1.0, 1.0], beale, &[0.0]),
        problem("jennrich and sampson", [0.3, 0.4], jennrich_sampson, &[124.362]),
        problem("helical valley", [-1.0, 0.0, 0.0], helical_valley, &[0.0]),
        problem("helical valley, far", [-10.0, 0.0, 0.0], helical_valley, &[0.0]),
        problem("bard", [1.0; 3], bard, &[8.21487e-3]),
        problem("gaussian", [0.4, 1.0, 0.0], gaussian, &[1.12793e-8]),
        problem("meyer", [0.02, 4000.0, 250.0], meyer, &[87.9458]),
        problem("box three-dimensional", [0.0, 10.0, 20.0], box_3d, &[0.0]),
        problem("wood", [-3.0, -1.0, -3.0, -1.0], wood, &[0.0]),
        problem("kowalik and osborne", [0.25, 0.39, 0.415, 0.39], kowalik_osborne, &[3.07505e-4]),
        problem("brown and dennis", [25.0, 5.0, -5.0, -1.0], brown_dennis, &[85_822.2]),
        problem("osborne 1", [0.5, 1.5, -1.0, 0.01, 0.02], osborne_1, &[5.46489e-5]),
        problem("biggs exp6", [1.0, 2.0, 1.0, 1.0, 1.0, 1.0], biggs_exp6, &[0.0, 5.65565e-3]),
        problem("osborne 2", OSBORNE_2_START, osborne_2, &[4.01377e-2]),
        problem("watson, 6", [0.0; 6], watson, &[2.28767e-3]),
        problem("watson, 9", [0.0; 9], watson, &[1.39976e-6]),
        problem("penalty 1", [1.0, 2.0, 3.0, 4.0], penalty_1, &[2.24997e-5]),
        problem("penalty 2", [0.5; 4], penalty_2, &[9.37629e-6]),
        problem("brown almost-linear", [0.5; 10], brown_almost_linear, &[0.0, 1.0]),
        problem("broyden tridiagonal", [-1.0; 10], broyden_tridiagonal, &[0.0]),
        problem("linear, full rank", [1.0; 5], linear_full_rank, &[5.0]),
        problem("linear, rank 1", [1.0; 5], linear_rank_1, &[15.0 / 7.0]),
        problem("chebyquad, 8", chebyquad_start(8), chebyquad, &[3.51687e-3]),
        problem("chebyquad, 9", chebyquad_start(9), chebyquad, &[0.0]),
        problem("chebyquad, 10", chebyquad_start(10), chebyquad, &[6.50395e-3]),
    ]
}

/// Half of J's columns vanish at the minimum.
pub(crate) fn powell_singular() -> [Problem; 2] {
    let residuals = |x: &[C]| {
        let (middle, ends) = (x[1] - x[2] * 2.0, x[0] - x[3]);
        let (left, right) = (x[0] + x[1] * 10.0, (x[2] - x[3]) * 5.0_f64.sqrt());
        vec![left, right, middle * middle, ends * ends * 10.0_f64.sqrt()]
    };
    [
        problem("powell singular", [3.0, -1.0, 0.0, 1.0], residuals, &[0.0]),
        problem("powell singular, far", [30.0, -10.0, 0.0, 10.0], residuals, &[0.0]),
    ]
}

fn real(value: f64) -> C {
    C::new(value, 0.0)
}

/// i = 1 … `count`, as numbers.
fn count(count: usize) -> impl Iterator<Item = f64> {
    (1..=count).map(|i| i as f64)
}

fn rosenbrock(x: &[C]) -> Vec<C> {
    vec![(x[1] - x[0] * x[0]) * 10.0, real(1.0) - x[0]]
}

fn freudenstein_roth(x: &[C]) -> Vec<C> {
    let (a, b) = (x[0], x[1]);
    vec![a - 13.0 + ((-b + 5.0) * b - 2.0) * b, a - 29.0 + ((b + 1.0) * b - 14.0) * b]
}

fn powell_badly_scaled(x: &[C]) -> Vec<C> {
    vec![x[0] * x[1] * 1e4 - 1.0, (-x[0]).exp() + (-x[1]).exp() - 1.0001]
}

fn brown_badly_scaled(x: &[C]) -> Vec<C> {
    vec![x[0] - 1e6, x[1] - 2e-6, x[0] * x[1] - 2.0]
}

fn beale(x: &[C]) -> Vec<C> {
    let data = [1.5, 2.25, 2.625];
    data.iter().zip(1..).map(|(&y, i)| -(x[0] * (-x[1].powi(i) + 1.0)) + y).collect()
}

fn jennrich_sampson(x: &[C]) -> Vec<C> {
    count(10).map(|i| -((x[0] * i).exp() + (x[1] * i).exp()) + 2.0 + 2.0 * i).collect()
}

fn helical_valley(x: &[C]) -> Vec<C> {
    let slope = x[1] / x[0];
    // The library's complex arc tangent rounds so small a step away.
    let angle = C::new(slope.re.atan(), slope.im / (1.0 + slope.re * slope.re));
    let turn = angle / std::f64::consts::TAU + if x[0].re < 0.0 { 0.5 } else { 0.0 };
    let radius = (x[0] * x[0] + x[1] * x[1]).sqrt();
    vec![(x[2] - turn * 10.0) * 10.0, (radius - 1.0) * 10.0, x[2]]
}

fn bard(x: &[C]) -> Vec<C> {
    let data = [0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39, 0.37, 0.58, 0.73, 0.96, 1.34, 2.10, 4.39];
    let row = |(y, u): (f64, f64)| {
        let (v, w) = (16.0 - u, u.min(16.0 - u));
        -(x[0] + real(u) / (x[1] * v + x[2] * w)) + y
    };
    data.into_iter().zip(count(15)).map(row).collect()
}

fn gaussian(x: &[C]) -> Vec<C> {
    let half = [0.0009, 0.0044, 0.0175, 0.0540, 0.1295, 0.2420, 0.3521, 0.3989];
    let row = |i: usize| {
        let off = -x[2] + (8.0 - (i + 1) as f64) / 2.0;
        x[0] * (-x[1] * off * off / 2.0).exp() - half[i.min(14 - i)]
    };
    (0..15).map(row).collect()
}

fn meyer(x: &[C]) -> Vec<C> {
    let data = [
        34780.0, 28610.0, 23650.0, 19630.0, 16370.0, 13720.0, 11540.0, 9744.0, 8261.0, 7030.0, 6005.0,
        5147.0, 4427.0, 3820.0, 3307.0, 2872.0,
    ];
    let row = |(y, i): (f64, f64)| x[0] * (x[1] / (x[2] + 45.0 + 5.0 * i)).exp() - y;
    data.into_iter().zip(count(16)).map(row).collect()
}

fn box_3d(x: &[C]) -> Vec<C> {
    let row = |i: f64| {
        let t = 0.1 * i;
        (-x[0] * t).exp() - (-x[1] * t).exp() - x[2] * ((-t).exp() - (-10.0 * t).exp())
    };
    count(10).map(row).collect()
}

fn wood(x: &[C]) -> Vec<C> {
    vec![
        (x[1] - x[0] * x[0]) * 10.0,
        -x[0] + 1.0,
        (x[3] - x[2] * x[2]) * 90.0_f64.sqrt(),
        -x[2] + 1.0,
        (x[1] + x[3] - 2.0) * 10.0_f64.sqrt(),
        (x[1] - x[3]) / 10.0_f64.sqrt(),
    ]
}

fn kowalik_osborne(x: &[C]) -> Vec<C> {
    let data = [0.1957, 0.1947, 0.1735, 0.1600, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246];
    let at = [4.0, 2.0, 1.0, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625];
    let row = |(y, u): (f64, f64)| {
        let (over, under) = ((x[1] + u) * u, (x[2] + u) * u + x[3]);
        -(x[0] * over / under) + y
    };
    data.into_iter().zip(at).map(row).collect()
}

fn brown_dennis(x: &[C]) -> Vec<C> {
    let row = |i: f64| {
        let t = i / 5.0;
        let (a, b) = (x[0] + x[1] * t - t.exp(), x[2] + x[3] * t.sin() - t.cos());
        a * a + b * b
    };
    count(20).map(row).collect()
}

fn osborne_1(x: &[C]) -> Vec<C> {
    let data = [
        0.844, 0.908, 0.932, 0.936, 0.925, 0.908, 0.881, 0.850, 0.818, 0.784, 0.751, 0.718, 0.685, 0.658,
        0.628, 0.603, 0.580, 0.558, 0.538, 0.522, 0.506, 0.490, 0.478, 0.467, 0.457, 0.448, 0.438, 0.431,
        0.424, 0.420, 0.414, 0.411, 0.406,
    ];
    let row = |(y, i): (f64, f64)| {
        let t = 10.0 * (i - 1.0);
        -(x[0] + x[1] * (-x[3] * t).exp() + x[2] * (-x[4] * t).exp()) + y
    };
    data.into_iter().zip(count(33)).map(row).collect()
}

fn biggs_exp6(x: &[C]) -> Vec<C> {
    let row = |i: f64| {
        let t = 0.1 * i;
        let data = (-t).exp() - 5.0 * (-10.0 * t).exp() + 3.0 * (-4.0 * t).exp();
        x[2] * (-x[0] * t).exp() - x[3] * (-x[1] * t).exp() + x[5] * (-x[4] * t).exp() - data
    };
    count(13).map(row).collect()
}

fn osborne_2(x: &[C]) -> Vec<C> {
    let data = [
        1.366, 1.191, 1.112, 1.013, 0.991, 0.885, 0.831, 0.847, 0.786, 0.725, 0.746, 0.679, 0.608, 0.655,
        0.616, 0.606, 0.602, 0.626, 0.651, 0.724, 0.649, 0.649, 0.694, 0.644, 0.624, 0.661, 0.612, 0.558,
        0.533, 0.495, 0.500, 0.423, 0.395, 0.375, 0.372, 0.391, 0.396, 0.405, 0.428, 0.429, 0.523, 0.562,
        0.607, 0.653, 0.672, 0.708, 0.633, 0.668, 0.645, 0.632, 0.591, 0.559, 0.597, 0.625, 0.739, 0.710,
        0.729, 0.720, 0.636, 0.581, 0.428, 0.292, 0.162, 0.098, 0.054,
    ];
    let row = |(y, i): (f64, f64)| {
        let t = (i - 1.0) / 10.0;
        let bump = |k: usize| {
            let off = -x[k + 7] + t;
            x[k] * (-off * off * x[k + 4]).exp()
        };
        -(x[0] * (-x[4] * t).exp() + bump(1) + bump(2) + bump(3)) + y
    };
    data.into_iter().zip(count(65)).map(row).collect()
}

fn watson(x: &[C]) -> Vec<C> {
    let row = |i: f64| {
        let t = i / 29.0;
        let (mut slope, mut sum, mut power) = (real(0.0), real(0.0), 1.0);
        for (j, &value) in x.iter().enumerate() {
            sum += value * power;
            if let Some(next) = x.get(j + 1) {
                slope += next * ((j + 1) as f64 * power);
            }
            power *= t;
        }
        slope - sum * sum - 1.0
    };
    count(29).map(row).chain([x[0], x[1] - x[0] * x[0] - 1.0]).collect()
}

fn penalty_1(x: &[C]) -> Vec<C> {
    let squares: C = x.iter().map(|x| x * x).sum();
    x.iter().map(|x| (x - 1.0) * 1e-5_f64.sqrt()).chain([squares - 0.25]).collect()
}

fn penalty_2(x: &[C]) -> Vec<C> {
    let (n, unit) = (x.len(), 1e-5_f64.sqrt());
    let y = |i: f64| (i / 10.0).exp() + ((i - 1.0) / 10.0).exp();
    let pairs = (1..n).map(|i| ((x[i] / 10.0).exp() + (x[i - 1] / 10.0).exp() - y((i + 1) as f64)) * unit);
    let singles = (1..n).map(|i| ((x[i] / 10.0).exp() - (-0.1_f64).exp()) * unit);
    let sum: C = x.iter().enumerate().map(|(j, x)| x * x * (n - j) as f64).sum();
    [x[0] - 0.2].into_iter().chain(pairs).chain(singles).chain([sum - 1.0]).collect()
}

fn brown_almost_linear(x: &[C]) -> Vec<C> {
    let (n, sum) = (x.len(), x.iter().sum::<C>());
    let product: C = x.iter().product();
    x[..n - 1].iter().map(|x| x + sum - (n + 1) as f64).chain([product - 1.0]).collect()
}

fn broyden_tridiagonal(x: &[C]) -> Vec<C> {
    let at = |i: Option<usize>| i.and_then(|i| x.get(i)).copied().unwrap_or_default();
    let row = |i: usize| (-x[i] * 2.0 + 3.0) * x[i] - at(i.checked_sub(1)) - at(Some(i + 1)) * 2.0 + 1.0;
    (0..x.len()).map(row).collect()
}

fn linear_full_rank(x: &[C]) -> Vec<C> {
    let sum: C = x.iter().sum();
    (0..10).map(|i| x.get(i).copied().unwrap_or_default() - sum * 0.2 - 1.0).collect()
}

fn linear_rank_1(x: &[C]) -> Vec<C> {
    let sum: C = x.iter().zip(count(x.len())).map(|(x, j)| x * j).sum();
    count(10).map(|i| sum * i - 1.0).collect()
}

fn chebyquad_start(n: usize) -> Vec<f64> {
    count(n).map(|j| j / (n + 1) as f64).collect()
}

/// The mean of Chebyshev's polynomial of every degree, moved to 0 … 1, less its integral.
fn chebyquad(x: &[C]) -> Vec<C> {
    let n = x.len();
    let mut means = vec![real(0.0); n];
    for &x in x {
        let at = x * 2.0 - 1.0;
        let (mut before, mut value) = (real(1.0), at);
        for mean in &mut means {
            *mean += value / n as f64;
            (before, value) = (value, at * value * 2.0 - before);
        }
    }
    let integral = |i: usize| if i.is_multiple_of(2) { -1.0 / ((i * i) as f64 - 1.0) } else { 0.0 };
    means.into_iter().enumerate().map(|(i, mean)| mean - integral(i + 1)).collect()
}
