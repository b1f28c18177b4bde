//! Options that choose renderer, ramp and solver, as `fit` and `track` share them.

use backlit_tracking::body::Parameters;
use backlit_tracking::fit::{FitOptions, Preset};
use backlit_tracking::optimize::Method;
use backlit_tracking::render::{MAX_SPHERES, Ramp, RendererKind};
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::error::ErrorKind;

use crate::numbers::within;
use crate::take_options::Segmentation;

/// What `--model` takes.
pub(crate) const MODEL_HELP: &str = "Body model: a file, or single_limb, upper_body or full_body";

/// What `--renderer` takes.
pub(crate) fn solid_help() -> String {
    format!(
        "Solid that stands for a limb: {}",
        RendererKind::listed(&RendererKind::ALL, "or", RendererKind::name)
    )
}

/// Which solid stands for a limb.
#[derive(Debug, Clone, Args)]
pub(crate) struct RendererArguments {
    #[arg(long, value_name = "SOLID", help = format!("{} [default: {}]", solid_help(), RendererKind::default()))]
    pub(crate) renderer: Option<RendererKind>,
    /// With the sphere tree: equal spheres along each limb [1 to 1024] [default: the limb's own, else 1 + ⌈2·length/radius⌉]
    #[arg(long, value_name = "N", requires = "renderer", value_parser = within(1..=MAX_SPHERES as u16))]
    pub(crate) spheres: Option<u16>,
}

impl RendererArguments {
    pub(crate) fn kind(&self) -> Result<Option<RendererKind>, clap::Error> {
        match (self.renderer, self.spheres) {
            (Some(RendererKind::SphereTree { .. }), spheres) => {
                Ok(Some(RendererKind::SphereTree { spheres: spheres.map(usize::from) }))
            }
            (_, Some(_)) => {
                let message = "--spheres is for --renderer sphere-tree\n";
                Err(clap::Error::raw(ErrorKind::ArgumentConflict, message))
            }
            (renderer, None) => Ok(renderer),
        }
    }
}

/// Words, each with its help and what it stands for.
pub(crate) type Words<T> = &'static [(&'static str, &'static str, T)];

/// Reads one of these words.
pub(crate) fn one_of<T: Copy + Send + Sync + 'static>(words: Words<T>) -> impl TypedValueParser<Value = T> {
    let known = words.iter().map(|(word, help, _)| PossibleValue::new(*word).help(*help));
    PossibleValuesParser::new(known).try_map(|text| {
        let known = words.iter().find(|(word, ..)| *word == text);
        known.map(|(.., value)| *value).ok_or("this is no word of the list")
    })
}

/// What the columns of a rotation are.
pub(crate) const PARAMETERS: Words<Parameters> = &[
    ("raw", "Four quaternion coefficients w x y z a rotation", Parameters::Raw),
    ("tangent", "Three radians a rotation", Parameters::Tangent),
];

/// How to fit.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "How to fit")]
pub(crate) struct SolverArguments {
    /// Set of choices to begin with: report (as in 2004) or robust; the options below change single choices
    #[arg(long, default_value_t = Preset::Robust)]
    pub(crate) preset: Preset,
    /// How silhouettes are made of a take's pictures [default: take]
    #[arg(long, value_name = "HOW", value_parser = one_of(Segmentation::WORDS))]
    segmentation: Option<Segmentation>,
    /// The solid.
    #[command(flatten)]
    pub(crate) renderer: RendererArguments,
    /// From distance to grey, in one stage: thesis, half, width=PX or distance=INNER,OUTER (pixels)
    /// [default: the preset's]
    #[arg(long)]
    pub(crate) ramp: Option<Ramp>,
    /// How steps are made: gauss-newton or lm [default: the preset's]
    #[arg(long)]
    pub(crate) method: Option<Method>,
    /// Numbers of a rotation that are solved for [default: the preset's]
    #[arg(long, value_parser = one_of(PARAMETERS))]
    pub(crate) parameters: Option<Parameters>,
    /// Damping at the start of a stage, in units of the mean of JᵀJ's diagonal; with lm, of a column's own entry if
    /// that is larger [0 to 1000000000000] [default: the preset's]
    #[arg(long, value_name = "FACTOR", value_parser = within(0.0..=1e12_f64))]
    pub(crate) damping: Option<f64>,
    /// Most iterations in all, rejected ones too, shared equally among the preset's stages
    /// [0 to 100000] [default: report 25, robust 60]
    #[arg(long, value_name = "N", value_parser = within(0..=100_000_usize))]
    pub(crate) iterations: Option<usize>,
    /// Run all iterations, whatever the cost does
    #[arg(long)]
    pub(crate) no_stop: bool,
}

impl SolverArguments {
    /// How silhouettes are made: as asked for, else as the preset does.
    pub(crate) fn segmentation(&self) -> Segmentation {
        self.segmentation.unwrap_or(Segmentation::Take)
    }

    pub(crate) fn options(&self) -> Result<FitOptions, clap::Error> {
        let mut options = FitOptions::preset(self.preset);
        if let Some(renderer) = self.renderer.kind()? {
            options.renderer = renderer;
        }
        if let Some(ramp) = self.ramp {
            options = options.with_ramp(ramp);
        }
        if let Some(method) = self.method {
            options.method = method;
        }
        if let Some(parameters) = self.parameters {
            options.parameters = parameters;
        }
        if let Some(damping) = self.damping {
            options.damping = damping;
        }
        if let Some(iterations) = self.iterations {
            options = options.with_iterations(iterations);
        }
        options.run_all = self.no_stop;
        Ok(options)
    }
}
