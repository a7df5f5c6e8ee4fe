#pragma once
// Manual pages and shell completions, generated from the same tables of options as --help.

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace shvr::cli {

struct ManualFile {
    std::string path;  ///< below the folder for shared data: "man/man1/shvr.1"
    std::string text;
};
/// Returns a manual page (man(7) macros) for the program and for each command and sub-command, and completions for
/// bash, zsh and fish. The same program always gives the same files.
std::vector<ManualFile> manual_of(const CLI::App& program, const std::string& version);

}  // namespace shvr::cli
