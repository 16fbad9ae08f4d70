//! `nima study`: experiments that report results.
//!
//! Each has a file with its arguments in `study/` and a line in the table below; the same code writes all results.

mod baselines;
mod clocks;
mod effects;
mod faults;
mod gates;
mod hands;
mod network;
mod passivity;
mod release;
mod sources;
mod stability;
mod stability_map;
mod timing;
mod tradeoff;
mod trials;
mod validation;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use nima_report::output;
use nima_screen::stderr::show_progress;
use nima_study::{Experiment, Findings as _};

/// Arguments that describe the experiment.
pub(super) trait ExperimentArguments: Args {
    type Experiment: Experiment;

    fn experiment(&self) -> anyhow::Result<Self::Experiment>;

    fn carry_out(&self, results: &Results) -> anyhow::Result<()> {
        results.of(&self.experiment()?)
    }
}

/// Arguments of one study, and where to write its results.
#[derive(Debug, Args)]
pub(super) struct StudyArguments<A: Args> {
    #[command(flatten)]
    asked: A,
    #[command(flatten)]
    results: Results,
}

/// Where to write the results of a study.
#[derive(Debug, Args)]
pub(super) struct Results {
    /// Write the results into this folder: JSON, tables (Markdown or CSV) and plots (SVG), named after the study (created if
    /// missing; replaces existing files and keeps their permissions; follows links; rejects input files, devices and pipes)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the results as one JSON object
    #[arg(long)]
    json: bool,
}

macro_rules! studies {
    ($($(#[$meaning:meta])* $name:ident($asked:ty),)*) => {
        #[derive(Debug, Subcommand)]
        pub(super) enum StudyCommand {
            $($(#[$meaning])* $name(StudyArguments<$asked>),)*
        }

        pub(super) fn run(command: &StudyCommand) -> anyhow::Result<()> {
            match command {
                $(StudyCommand::$name(study) => study.asked.carry_out(&study.results),)*
            }
        }
    };
}

studies! {
    /// Compare baseline methods with every mode, on recordings and scenes: prediction error relative to delayed reflection
    Baselines(baselines::BaselinesArguments),
    /// Measure the cost of each effect of a scene per tick, and the change of the force without it
    Effects(effects::EffectsArguments),
    /// Inject every kind of fault in every state; report detection, detection time, and the force error at the hand
    Faults(faults::FaultsStudy),
    /// Send extreme force requests through the gates and count violations of their limits
    Gates(gates::GatesStudy),
    /// Let simulated hands hold and release the handle; report how often, how strongly and how late the last gate acts
    Hands(hands::HandsStudy),
    /// Run two machines over a bad network, in every mode: force error, energy and stops over delay, jitter, loss, outages
    /// and clock faults
    Network(network::NetworkStudy),
    /// Release a handle pressed with up to 5 N: every mode, baseline and delay, with and without the governor
    Release(release::ReleaseStudy),
    /// Measure whether the loop gives energy to the hand, and whether a loose grip oscillates, in every mode and at every
    /// delay
    Passivity(passivity::Passivity),
    /// Compare every solver with an arbitrary-precision reference in extreme cases
    Stability(stability::Stability),
    /// Find by simulation which gain, delay and stiffness are stable with a gripping hand (takes minutes)
    StabilityMap(stability_map::StabilityMapStudy),
    /// Measure computing time and accuracy for every setting of the identification
    Tradeoff(tradeoff::TradeoffArguments),
    /// Compare the conditions of a user study, from a table of trials: tests, intervals, effect sizes, a mixed model
    Trials(trials::TrialsArguments),
    /// Measure the loop's timing while its console renders, all cores are busy, the window is blocked, or the disk is written
    /// heavily
    Timing(timing::TimingArguments),
    /// Repeat the paper's three validations on the simulated rig and compare the results
    Validation(validation::Validation),
}

impl Results {
    fn of<E: Experiment>(&self, experiment: &E) -> anyhow::Result<()> {
        let inputs = experiment.inputs();
        let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
        if let Some(out) = &self.out {
            // Checked before the computation, so that an invalid name does not waste it.
            let names: Vec<String> = [".json"].iter().chain(E::FILES).map(|end| name::<E>(end)).collect();
            output::folder(out, &names.iter().map(String::as_str).collect::<Vec<_>>(), &inputs)?;
        }
        let findings = experiment.run(&mut progress)?;
        if let Some(out) = &self.out {
            let json = (".json".to_owned(), serde_json::to_string_pretty(&findings)?);
            let files = [json].into_iter().chain(findings.files());
            let files: Vec<_> = files.map(|(end, text)| (name::<E>(&end), text)).collect();
            // Some names depend on the results, so they can be compared with the inputs only now.
            files.iter().try_for_each(|(name, _)| output::check(&out.join(name), &inputs))?;
            files.iter().try_for_each(|(name, text)| output::write(out, name, text))?;
        }
        if self.json { output::json(&findings) } else { output::line(findings.text().trim_end()) }?;
        findings.judge().map_err(anyhow::Error::msg)
    }
}

fn name<E: Experiment>(end: &str) -> String {
    format!("{}{end}", E::NAME)
}

fn progress(done: usize, of: usize, what: &str) {
    show_progress((done < of).then(|| format!("{}/{of} {what}", done + 1)).as_deref());
}
