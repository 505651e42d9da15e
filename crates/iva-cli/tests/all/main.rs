//! The command as a process, in one program: linking takes longer than compiling.

mod exit_codes;
mod full_disk;
mod hostile;
mod interrupt;
mod output_folder;
mod resume;
