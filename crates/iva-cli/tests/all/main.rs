//! Tests of the command as a process; all are in one program, because linking each would take long.

mod exit_codes;
mod full_disk;
mod hostile;
mod interrupt;
mod output_folder;
mod process;
mod resume;
