//! The command line of `iva`.

// The comments are what a terminal shows as help, brackets and all.
#![allow(rustdoc::broken_intra_doc_links, rustdoc::invalid_html_tags)]

use std::ffi::OsString;
use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, RangedU64ValueParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};
use iva_store::table_file::{Format, Style};
use iva_sweep::dynamics::starts::{NAMES, place_of};
use iva_sweep::fields::nearest;
use iva_sweep::study::Table;
use iva_sweep::sweep::MAX_THREADS;

use crate::error::Error;

/// What was asked for.
#[derive(Debug, Parser)]
#[command(
    name = "iva",
    version,
    max_term_width = 80,
    about = "Reference simulator for impact vibration absorbers",
    after_help = "Example: the settling time of a structure over the clearance of its absorber\n\n  \
                  iva examples                             copies studies into the folder studies\n  \
                  iva check studies/siva_clearance.toml\n  \
                  iva sweep studies/siva_clearance.toml\n\n\
                  The tables are then in results/siva_clearance, as Parquet files.\n\n\
                  Exit codes: 0 done, 1 writing failed or internal fault, 2 bad input (also a study that \
                  cannot be read), 130 interrupted."
)]
pub struct Cli {
    /// The command.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run every point of the study and write the tables
    #[command(after_help = "Example: damping over clearance and mass ratio. In my.toml\n\n  \
                            version = 1\n  \
                            [primary]\n  \
                            damping_ratio = 0.01\n  \
                            [absorber]\n  \
                            kind = \"siva\"\n  \
                            restitution = 0.5\n  \
                            [start]\n  \
                            displacement = 1.0\n  \
                            [run]\n  \
                            periods = 60\n  \
                            [sweep]\n  \
                            relative_clearance = { start = 0.1, stop = 1.2, count = 111 }\n  \
                            mass_ratio = [0.05, 0.1, 0.15, 0.2]\n\n\
                            then\n\n  \
                            iva sweep my.toml\n\n\
                            prints the best points and writes\n\n  \
                            results/my/summary         a row a point\n  \
                            results/my/impacts         a row an impact\n  \
                            results/my/study.toml      the study, every default filled in\n  \
                            results/my/manifest.json   which parts are complete, with checksums\n\n\
                            After Ctrl-C, a crash or a full disk\n\n  \
                            iva sweep my.toml --resume\n\n\
                            runs what is missing.")]
    Sweep(SweepArgs),
    /// Run a study without [sweep], or one point of one with it, and write every table
    #[command(
        max_term_width = 80,
        after_help = "Example: one decay, its motion sampled 500 times a period. In one.toml\n\n  \
                            version = 1\n  \
                            [primary]\n  \
                            damping_ratio = 0.01\n  \
                            [absorber]\n  \
                            kind = \"siva\"\n  \
                            mass_ratio = 0.1\n  \
                            restitution = 0.5\n  \
                            relative_clearance = 0.6\n  \
                            [start]\n  \
                            displacement = 1.0\n  \
                            [run]\n  \
                            periods = 30\n  \
                            samples_per_period = 500   # of the trajectory; default 200\n\n\
                            then\n\n  \
                            iva run one.toml\n\n\
                            prints the measures and writes summary, impacts, episodes, envelope,\n\
                            stroboscope and trajectory into results/one (fewer if run.tables or --tables says so)."
    )]
    Run(RunPointArgs),
    /// Check a study, count its points, and estimate time and size
    #[command(after_help = "Example:\n\n  iva check studies/siva_clearance.toml\n\n\
                            Nothing is written. A few points spread over the study are run for the \
                            estimate.")]
    Check(CheckArgs),
    /// Find the periodic orbit near the start of a study, stable or not, with its multipliers
    #[command(
        after_help = "Example: the motion that a structure under a harmonic force settles on\n\n  \
                            iva orbit my.toml --settle 300\n\n\
                            The study has one [force] or motion of the base, harmonic, and no [sweep]."
    )]
    Orbit(OrbitArgs),
    /// Follow that orbit over a field of the study, and find where it changes its kind
    #[command(after_help = "Example: over the clearance, with a table of its points\n\n  \
                            iva branch my.toml --settle 300 --over clearance --from 0.5 --to 8 \\\n      \
                            --csv branch.csv\n\n\
                            Printed are folds, pitchforks, flips and Neimark-Sacker points, and where another\n\
                            sequence of events begins. The study gives the field itself; of one absorber in\n\
                            a list it is absorber.1.clearance.")]
    Branch(BranchArgs),
    /// Let a field of a study go up and down, each steady state from the end of the last
    #[command(after_help = "Example: over 200 clearances, with a table of all strobes\n\n  \
                            iva diagram my.toml --over clearance --from 0.5 --to 8 --count 200 \\\n      \
                            --csv diagram.csv\n\n\
                            Where the way up is another than the way down there are two steady states.")]
    Diagram(DiagramArgs),
    /// Decide which steady state each start of a plane ends in
    #[command(after_help = "Example: over displacement and velocity of the structure\n\n  \
                            iva basins my.toml --across displacement,-4,4,100 \\\n      \
                            --up velocity,-4,4,100 --csv basins.csv\n\n\
                            Labels are numbers of steady states; -2 is a motion without impacts, -1 not\n\
                            decided within the cycles, or for sure.")]
    Basins(BasinsArgs),
    /// Choose the numbers of a design so that it holds although much is not known exactly; needs
    /// Python: pip install 'iva-dynamics[optimise]'
    #[command(disable_help_flag = true)]
    Optimise(PythonArgs),
    /// Identify structure and absorber from a measured decay; needs Python: pip install
    /// 'iva-dynamics[fit]'
    #[command(disable_help_flag = true)]
    Identify(PythonArgs),
    /// Drag a scene in the browser: one page with the simulator in it; needs Python: pip install
    /// iva-dynamics
    #[command(disable_help_flag = true)]
    Explore(PythonArgs),
    /// Copy the studies that come with the program into a folder, with the records that they read
    #[command(
        after_help = "Example:\n\n  iva examples\n  iva sweep studies/siva_clearance.toml\n\n\
                            A file that is there already is never replaced."
    )]
    Examples(ExamplesArgs),
    /// Draw the figures of the paper anew; needs Python: pip install 'iva-dynamics[paper]'
    #[command(disable_help_flag = true)]
    Reproduce(PythonArgs),
}

/// Arguments of `iva examples`.
#[derive(Debug, Args)]
pub struct ExamplesArgs {
    /// The folder, which is made if it is not there
    #[arg(value_name = "DIR", default_value = "studies")]
    pub folder: PathBuf,
}

/// Arguments of `iva sweep`.
#[derive(Debug, Args)]
pub struct SweepArgs {
    /// Go on with the sweep that the folder holds: its complete parts are checked and kept. Without
    /// one it begins
    #[arg(long)]
    pub resume: bool,
    /// Everything else.
    #[command(flatten)]
    pub run: RunArgs,
}

/// Arguments of `iva sweep` and `iva run`.
#[derive(Debug, Args)]
pub struct RunArgs {
    /// The study file (TOML)
    #[arg(value_name = "STUDY.toml")]
    pub study: PathBuf,
    /// Folder for the tables [default: results/<name of the study file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Tables to write, instead of run.tables of the study: summary, impacts, episodes, envelope,
    /// stroboscope; `iva run` also trajectory
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = table)]
    pub tables: Option<Vec<Table>>,
    /// What the tables are written as
    #[arg(
        long,
        value_parser = formats(),
        default_value_t,
        hide_possible_values = true,
        value_name = "FORMAT",
        help = "What the tables are written as: parquet, arrow or csv"
    )]
    pub format: Format,
    /// With --format csv: a second line with the unit of each column
    #[arg(long)]
    pub units_row: bool,
    /// Worker threads [default: one a core]; the results do not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=MAX_THREADS as i64))]
    pub threads: Option<u16>,
    /// Add lines of JSON to this file: what was run, each part written, how it ended
    #[arg(long, value_name = "FILE")]
    pub log: Option<PathBuf>,
    /// Print nothing but errors
    #[arg(long)]
    pub quiet: bool,
    /// Replace the tables that the folder holds, once the new ones are complete
    #[arg(long)]
    pub overwrite: bool,
}

/// Arguments of `iva run`.
#[derive(Debug, Args)]
pub struct RunPointArgs {
    /// Of a study with [sweep], run this point: its number in the tables
    #[arg(long, value_name = "N")]
    pub point: Option<u64>,
    /// Run it again in numbers of twice the precision (some fifty times as long): print what the
    /// errors of the run are, and write those of all numbers into the folder errors
    #[arg(long)]
    pub verify: bool,
    /// Everything else.
    #[command(flatten)]
    pub run: RunArgs,
}

impl RunArgs {
    /// How the tables are to be written.
    ///
    /// # Errors
    /// [`Error::Refused`] for a row of units in a format that carries them in its metadata.
    pub(crate) fn style(&self) -> Result<Style, Error> {
        let &Self { format, units_row, .. } = self;
        if units_row && format != Format::Csv {
            return Err(Error::Refused(format!(
                "--units-row: {format} files carry the units in their metadata; give --format csv"
            )));
        }
        Ok(Style { format, units_row })
    }
}

/// Arguments of `iva check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// The study file (TOML)
    #[arg(value_name = "STUDY.toml")]
    pub study: PathBuf,
}

/// Arguments of `iva orbit`.
#[derive(Debug, Args)]
pub struct OrbitArgs {
    /// The study file (TOML)
    #[arg(value_name = "STUDY.toml")]
    pub study: PathBuf,
    /// Number of periods of the force after which the orbit repeats
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub periods: u32,
    /// Number of periods that are run before the search
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub settle: u64,
    /// Only an orbit that is its own mirror image half a cycle later
    #[arg(long)]
    pub symmetric: bool,
    /// Solve it to twice the precision, and tell the error of the orbit in doubles
    #[arg(long)]
    pub verify: bool,
}

/// Arguments of `iva branch`.
#[derive(Debug, Args)]
pub struct BranchArgs {
    /// The orbit to begin with.
    #[command(flatten)]
    pub orbit: OrbitArgs,
    /// The field that is changed, such as clearance or force.frequency
    #[arg(long, value_name = "FIELD")]
    pub over: String,
    /// Its smallest value
    #[arg(long, value_name = "LOW", allow_negative_numbers = true)]
    pub from: f64,
    /// Its largest value
    #[arg(long, value_name = "HIGH", allow_negative_numbers = true)]
    pub to: f64,
    /// Longest step, as a share of the range and of the sizes of the state
    #[arg(long, value_name = "SHARE", default_value_t = 0.02)]
    pub step: f64,
    /// Most points to either side
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = least_one())]
    pub points: u64,
    /// Write the points of the branch to this file, which must not exist
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

/// Arguments of `iva diagram`.
#[derive(Debug, Args)]
pub struct DiagramArgs {
    /// The study file (TOML)
    #[arg(value_name = "STUDY.toml")]
    pub study: PathBuf,
    /// The field that is changed, such as clearance or force.frequency
    #[arg(long, value_name = "FIELD")]
    pub over: String,
    /// Its smallest value
    #[arg(long, value_name = "LOW", allow_negative_numbers = true)]
    pub from: f64,
    /// Its largest value
    #[arg(long, value_name = "HIGH", allow_negative_numbers = true)]
    pub to: f64,
    /// Number of values
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = least_one())]
    pub count: u64,
    /// Number of periods of the force that are left out at each value
    #[arg(long, value_name = "N", default_value_t = 300)]
    pub discard: u64,
    /// Number of periods that follow, at whose ends the state is kept
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = least_one())]
    pub keep: u64,
    /// Write all strobes to this file, which must not exist
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

/// A number of the start with values at equal distances.
#[derive(Debug, Clone, Copy)]
pub struct AxisOfStarts {
    /// The place of the number, see [`place_of`].
    pub place: usize,
    /// The smallest value.
    pub low: f64,
    /// The largest value.
    pub high: f64,
    /// Number of values.
    pub count: usize,
}

impl std::str::FromStr for AxisOfStarts {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let rule = || {
            let names = NAMES.join(", ");
            format!(
                "give NAME,LOW,HIGH,COUNT with a name out of {names}; of several absorbers with an index, as in gap_velocity.1"
            )
        };
        let parts: Vec<&str> = text.split(',').map(str::trim).collect();
        let [name, low, high, count] = parts[..] else { return Err(rule()) };
        let place = place_of(name).ok_or_else(rule)?;
        let number = |text: &str| text.parse::<f64>().ok().filter(|it| it.is_finite());
        let (low, high) = number(low).zip(number(high)).ok_or_else(rule)?;
        let count = count.parse().ok().filter(|count| *count > 0).ok_or_else(rule)?;
        if low > high || (low == high && count > 1) {
            return Err("give the smaller number first".to_owned());
        }
        Ok(Self { place, low, high, count })
    }
}

/// Arguments of `iva basins`.
#[derive(Debug, Args)]
pub struct BasinsArgs {
    /// The study file (TOML)
    #[arg(value_name = "STUDY.toml")]
    pub study: PathBuf,
    /// The number of the start that goes across, its range, and how many values
    #[arg(long, value_name = "NAME,LOW,HIGH,COUNT", allow_hyphen_values = true)]
    pub across: AxisOfStarts,
    /// The number of the start that goes up, its range, and how many values
    #[arg(long, value_name = "NAME,LOW,HIGH,COUNT", allow_hyphen_values = true)]
    pub up: AxisOfStarts,
    /// Most periods of the force that are run from each start
    #[arg(long, value_name = "N", default_value_t = 150, value_parser = least_one())]
    pub most_cycles: u64,
    /// Most periods after which a steady state repeats
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub most_periods: u32,
    /// Write the label of each start to this file, which must not exist
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

/// Arguments of a command that only the Python package understands: anything.
#[derive(Debug, Args)]
pub struct PythonArgs {
    /// What it is to do; `--help` of the command in the Python package lists it
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "ARGUMENTS")]
    pub arguments: Vec<OsString>,
}

/// A whole number from 1 on; in a billion periods or values no command comes to its end.
fn least_one() -> RangedU64ValueParser {
    clap::value_parser!(u64).range(1..=1_000_000_000)
}

/// The formats by their names.
fn formats() -> impl TypedValueParser<Value = Format> {
    let names = PossibleValuesParser::new(Format::ALL.map(Format::name));
    names.map(|name| Format::from_name(&name).unwrap_or_default())
}

fn table(name: &str) -> Result<Table, String> {
    let known = Table::ALL.map(Table::name);
    Table::from_name(name).ok_or_else(|| match nearest(name, known.into_iter()) {
        Some(near) => format!("no such table; did you mean `{near}`?"),
        None => format!("no such table; give names out of {}", known.join(", ")),
    })
}
