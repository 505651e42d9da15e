//! The command line from end to end: exit codes, files, bytes.

use std::fs::{self, File};
use std::io::Cursor;
use std::path::{Path, PathBuf};

use arrow_array::RecordBatch;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use parquet::file::reader::{FileReader, SerializedFileReader};

use std::sync::atomic::AtomicBool;

use super::*;
use crate::cell::{number, text};
use iva_store::folder::HEADER;
use iva_study::read_study;
use iva_sweep::columns::SCHEMA_VERSION;
use iva_sweep::sweep::Workers;

mod faults;

const SINGLE: &str = "version = 1\n[primary]\ndamping_ratio = 0.01\n[absorber]\nkind = \"siva\"\n\
    mass_ratio = 0.1\nrestitution = 0.5\nrelative_clearance = 0.6\n[start]\ndisplacement = 1.0\n\
    [run]\nperiods = 20\n";
const GRID: &str = "[sweep]\nrelative_clearance = { start = 0.1, stop = 1.2, count = 31 }\n\
    mass_ratio = [0.05, 0.1]\n";

struct Place {
    root: tempfile::TempDir,
}

impl Place {
    fn new() -> Self {
        Self { root: tempfile::tempdir().unwrap() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.root.path().join(name)
    }

    fn study(&self, text: &str) -> PathBuf {
        let path = self.path("my.toml");
        fs::write(&path, text).unwrap();
        path
    }

    /// Runs `iva COMMAND my.toml --out out --quiet …`.
    fn iva(&self, command: &str, more: &[&str]) -> i32 {
        let out = self.path("out");
        let mut args: Vec<OsString> = vec!["iva".into(), command.into()];
        args.push(self.path("my.toml").into());
        args.extend(["--out".into(), out.into(), "--quiet".into()]);
        args.extend(more.iter().map(OsString::from));
        main_with_args(args)
    }
}

fn read(path: &Path) -> Vec<RecordBatch> {
    let file = File::open(path).unwrap();
    let reader = ParquetRecordBatchReaderBuilder::try_new(file).unwrap();
    reader.build().unwrap().map(Result::unwrap).collect()
}

fn rows(path: &Path) -> usize {
    read(path).iter().map(RecordBatch::num_rows).sum()
}

/// The bytes of the file of impacts of the small grid, written in a format.
fn impacts_as(format: &str, more: &[&str]) -> Vec<u8> {
    let place = Place::new();
    place.study(&format!("{SINGLE}{GRID}"));
    assert_eq!(place.iva("sweep", &[&["--format", format], more].concat()), EXIT_OK);
    fs::read(place.path(&format!("out/impacts/part-00000.{format}"))).unwrap()
}

#[test]
fn every_format_holds_the_same_rows() {
    let place = Place::new();
    place.study(&format!("{SINGLE}{GRID}"));
    assert_eq!(place.iva("sweep", &[]), EXIT_OK);
    let path = place.path("out/impacts/part-00000.parquet");
    let (parquet, total) = (&read(&path)[0], rows(&path));

    let arrow = impacts_as("arrow", &[]);
    let reader = arrow_ipc::reader::FileReader::try_new(Cursor::new(&arrow), None).unwrap();
    assert_eq!(reader.schema().fields(), parquet.schema().fields());
    assert_eq!(reader.schema().metadata()["iva.part_points"], "62");
    let batches: Vec<RecordBatch> = reader.map(Result::unwrap).collect();
    assert_eq!(batches.iter().map(RecordBatch::num_rows).sum::<usize>(), total);
    assert_eq!(batches[0].slice(0, 5).columns(), parquet.slice(0, 5).columns());

    let csv = String::from_utf8(impacts_as("csv", &[])).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert!(lines[0].starts_with("point,impact,time,wall,displacement,"), "{}", lines[0]);
    assert_eq!(lines.len() - 1, total);
    for (row, line) in lines[1..=parquet.num_rows()].iter().enumerate() {
        let time: f64 = line.split(',').nth(2).unwrap().parse().unwrap();
        // Shortest digits that read back as the same double.
        assert_eq!(Some(time), number(parquet, "time", row));
    }
    let with_units = String::from_utf8(impacts_as("csv", &["--units-row"])).unwrap();
    assert_eq!(with_units.lines().nth(1).unwrap().split(',').nth(2), Some("1/ωn"));
    assert_eq!(with_units.lines().count(), lines.len() + 1);

    for format in ["arrow", "csv"] {
        assert_eq!(
            impacts_as(format, &["--threads", "1"]),
            impacts_as(format, &["--threads", "3"])
        );
    }
}

#[test]
fn a_log_has_a_line_of_json_for_every_step() {
    let place = Place::new();
    place.study(&format!("{SINGLE}{GRID}"));
    let log = place.path("log.jsonl");
    let more = ["--log", log.to_str().unwrap()];
    assert_eq!(place.iva("sweep", &more), EXIT_OK);
    assert_eq!(place.iva("sweep", &more), EXIT_BAD_INPUT);
    let lines: Vec<serde_json::Value> = fs::read_to_string(&log)
        .unwrap()
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let events: Vec<&str> = lines.iter().map(|line| line["event"].as_str().unwrap()).collect();
    assert_eq!(events, ["start", "checked", "part", "finished", "start", "failed"]);
    assert!(lines.iter().all(|line| line["time"].as_f64().unwrap() > 1.7e9));
    assert_eq!(lines[0]["points"], 62);
    assert_eq!(lines[1]["parts"], 1);
    assert_eq!(lines[2]["rows_so_far"]["summary"], 62);
    assert_eq!(lines[5]["exit_code"], 2);
    assert!(lines[5]["message"].as_str().unwrap().contains("--overwrite"));
    assert_eq!(place.iva("sweep", &["--log", "/no/such/folder/log"]), EXIT_BAD_INPUT);
}

#[test]
fn one_point_of_a_grid_can_be_run_by_itself() {
    let place = Place::new();
    place.study(&format!("{SINGLE}{GRID}"));
    assert_eq!(place.iva("sweep", &[]), EXIT_OK);
    let summary = &read(&place.path("out/summary/part-00000.parquet"))[0];
    assert_eq!(place.iva("run", &["--overwrite"]), EXIT_BAD_INPUT);
    assert_eq!(place.iva("run", &["--point", "62", "--overwrite"]), EXIT_BAD_INPUT);
    assert_eq!(place.iva("run", &["--point", "17", "--overwrite"]), EXIT_OK);
    let single = &read(&place.path("out/summary/part-00000.parquet"))[0];
    for column in ["impacts", "settling_time_5", "energy_final"] {
        assert_eq!(number(single, column, 0), number(summary, column, 17), "{column}");
    }
    assert!(place.path("out/trajectory/part-00000.parquet").exists());
    place.study(SINGLE);
    assert_eq!(place.iva("run", &["--point", "0", "--overwrite"]), EXIT_BAD_INPUT);
}

#[test]
fn a_quantity_given_twice_is_refused_even_if_an_axis_replaces_it() {
    let place = Place::new();
    place.study(&format!("{SINGLE}{GRID}").replace("restitution", "gap = 0.01\nrestitution"));
    assert_eq!(place.iva("sweep", &[]), EXIT_BAD_INPUT);
    assert!(!place.path("out").exists());
}

#[test]
fn another_format_replaces_the_tables_of_the_first() {
    let place = Place::new();
    place.study(&format!("{SINGLE}{GRID}"));
    assert_eq!(place.iva("sweep", &[]), EXIT_OK);
    assert_eq!(place.iva("sweep", &["--format", "csv"]), EXIT_BAD_INPUT);
    assert_eq!(place.iva("sweep", &["--format", "csv", "--overwrite"]), EXIT_OK);
    let names: Vec<_> = fs::read_dir(place.path("out/summary"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    assert_eq!(names, ["part-00000.csv"]);
    assert_eq!(place.iva("sweep", &["--units-row"]), EXIT_BAD_INPUT);
    assert_eq!(place.iva("sweep", &["--format", "xlsx"]), EXIT_BAD_INPUT);
}

#[test]
fn a_sweep_writes_its_tables() {
    let place = Place::new();
    place.study(&format!("{SINGLE}{GRID}"));
    assert_eq!(place.iva("sweep", &[]), EXIT_OK);
    let summary = place.path("out/summary/part-00000.parquet");
    assert_eq!(rows(&summary), 62);
    let batch = &read(&summary)[0];
    assert_eq!(number(batch, "point", 61), Some(61.0));
    assert_eq!(number(batch, "relative_clearance", 61), Some(1.2));
    assert_eq!(number(batch, "mass_ratio", 60), Some(0.05));
    assert_eq!(text(batch, "outcome", 0), Some("finished"));
    let listed: f64 = (0..62).filter_map(|row| number(batch, "impacts", row)).sum();
    let impacts = place.path("out/impacts/part-00000.parquet");
    assert_eq!(rows(&impacts) as f64, listed);
    assert!(!place.path("out/episodes").exists());
    let resolved = fs::read_to_string(place.path("out/study.toml")).unwrap();
    assert!(resolved.starts_with(HEADER));
}

#[test]
fn metadata_stand_in_the_arrow_schema_and_in_the_parquet_keys() {
    let place = Place::new();
    place.study(&format!("{SINGLE}{GRID}"));
    assert_eq!(place.iva("sweep", &["--tables", "episodes"]), EXIT_OK);
    let path = place.path("out/episodes/part-00000.parquet");
    let reader = ParquetRecordBatchReaderBuilder::try_new(File::open(&path).unwrap()).unwrap();
    let schema = reader.schema();
    assert_eq!(schema.metadata()["iva.schema_version"], SCHEMA_VERSION.to_string());
    assert_eq!(schema.field_with_name("stick_time").unwrap().metadata()["unit"], "1/ωn");
    let reader = SerializedFileReader::new(File::open(&path).unwrap()).unwrap();
    let metadata = reader.metadata().file_metadata();
    let keys: Vec<&str> =
        metadata.key_value_metadata().unwrap().iter().map(|pair| pair.key.as_str()).collect();
    for key in ["iva.schema_version", "iva.version", "iva.units", "iva.sign_conventions"] {
        assert_eq!(keys.iter().filter(|other| **other == key).count(), 1, "{key}: {keys:?}");
    }
    let created_by = metadata.created_by().unwrap();
    assert!(created_by.starts_with("iva-dynamics "), "{created_by}");
}

#[test]
fn the_bytes_do_not_depend_on_threads_and_reading_back_the_resolved_study_gives_them_again() {
    let place = Place::new();
    place.study(&format!("{SINGLE}{GRID}"));
    let files =
        ["out/study.toml", "out/summary/part-00000.parquet", "out/impacts/part-00000.parquet"];
    let bytes = || files.map(|name| fs::read(place.path(name)).unwrap());
    assert_eq!(place.iva("sweep", &["--threads", "1"]), EXIT_OK);
    let one = bytes();
    for threads in ["2", "7"] {
        assert_eq!(place.iva("sweep", &["--threads", threads, "--overwrite"]), EXIT_OK);
        assert!(bytes() == one, "{threads} threads");
    }
    fs::copy(place.path("out/study.toml"), place.path("my.toml")).unwrap();
    assert_eq!(place.iva("sweep", &["--overwrite"]), EXIT_OK);
    assert!(bytes() == one, "the resolved study");
}

#[test]
fn parts_of_short_runs_have_the_most_points() {
    let place = Place::new();
    let grid = "[sweep]\nrelative_clearance = { start = 0.5, stop = 1.2, count = 262200 }\n";
    place.study(&format!("{}{grid}", SINGLE.replace("20", "0.5")));
    assert_eq!(place.iva("sweep", &["--tables", "summary"]), EXIT_OK);
    assert_eq!(rows(&place.path("out/summary/part-00000.parquet")), 262_144);
    let last = place.path("out/summary/part-00001.parquet");
    assert_eq!(rows(&last), 262_200 - 262_144);
    assert_eq!(number(&read(&last)[0], "point", 0), Some(262_144.0));
}

#[test]
fn a_run_writes_all_tables_and_the_trajectory() {
    let place = Place::new();
    place.study(&format!("{SINGLE}samples_per_period = 50\n"));
    assert_eq!(place.iva("run", &[]), EXIT_OK);
    for table in ["summary", "impacts", "episodes", "envelope", "trajectory"] {
        assert!(place.path(&format!("out/{table}/part-00000.parquet")).exists(), "{table}");
    }
    assert_eq!(rows(&place.path("out/episodes/part-00000.parquet")), 0);
    let impacts = rows(&place.path("out/impacts/part-00000.parquet"));
    let trajectory = rows(&place.path("out/trajectory/part-00000.parquet"));
    assert!(impacts > 10);
    assert_eq!(trajectory, 20 * 50 + 1 + 2 * impacts);
}

#[test]
fn bad_input_ends_with_2_and_leaves_no_folder() {
    let place = Place::new();
    let sweep = format!("{SINGLE}{GRID}");
    for (study, command, more) in [
        (SINGLE, "sweep", &[][..]),
        (&sweep, "run", &[]),
        (&sweep, "sweep", &["--threads", "0"]),
        (&sweep, "sweep", &["--tables", "impact"]),
        (&sweep, "sweep", &["--tables", "trajectory"]),
        (&sweep, "swep", &[]),
        (&SINGLE.replace("0.5", "1.5"), "run", &[]),
        (&SINGLE.replace("1.0", "0.0"), "run", &[]),
        (&SINGLE.replace("periods = 20", ""), "run", &[]),
        (&format!("{SINGLE}[report]\nbest = 1\n"), "run", &[]),
    ] {
        place.study(study);
        assert_eq!(place.iva(command, more), EXIT_BAD_INPUT, "{command} {more:?}\n{study}");
        assert!(!place.path("out").exists());
    }
}

#[test]
fn tables_are_only_replaced_on_demand() {
    let place = Place::new();
    place.study(SINGLE);
    assert_eq!(place.iva("run", &[]), EXIT_OK);
    let before = fs::read(place.path("out/summary/part-00000.parquet")).unwrap();
    place.study(&SINGLE.replace("20", "10"));
    assert_eq!(place.iva("run", &[]), EXIT_BAD_INPUT);
    assert_eq!(fs::read(place.path("out/summary/part-00000.parquet")).unwrap(), before);
    assert_eq!(place.iva("run", &["--overwrite", "--tables", "summary"]), EXIT_OK);
    assert_ne!(fs::read(place.path("out/summary/part-00000.parquet")).unwrap(), before);
    assert!(!place.path("out/trajectory").exists());
}

#[test]
fn an_output_folder_below_a_file_is_bad_input() {
    let place = Place::new();
    place.study(SINGLE);
    fs::write(place.path("out"), "mine").unwrap();
    assert_eq!(place.iva("run", &["--overwrite"]), EXIT_BAD_INPUT);
    assert_eq!(fs::read_to_string(place.path("out")).unwrap(), "mine");
}

#[test]
fn help_and_version_end_with_0() {
    for args in [&["iva", "--help"][..], &["iva", "--version"], &["iva", "sweep", "--help"]] {
        assert_eq!(main_with_args(args.iter().map(OsString::from).collect()), EXIT_OK);
    }
    assert_eq!(main_with_args(vec!["iva".into()]), EXIT_BAD_INPUT);
}

#[test]
fn the_studies_of_the_repository_are_valid() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies");
    for (name, points) in [("siva_clearance.toml", 444), ("siva_restitution.toml", 555)] {
        let file = read_study(&folder.join(name)).unwrap();
        file.validate(&Workers::new(Some(1)).unwrap(), &AtomicBool::new(false), &|_| {}).unwrap();
        assert_eq!(file.study.points().unwrap(), points);
    }
}
