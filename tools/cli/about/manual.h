#pragma once
// Manual pages and shell completions, from the tables of options that --help prints too.

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace shvr::cli {

struct ManualFile {
    std::string path;  ///< below the folder for shared data: "man/man1/shvr.1"
    std::string text;
};
/// A page for the program and for each command and command of a command, in the macros of man(7), and a completion each
/// for bash, zsh and fish. Equal programs give equal files.
std::vector<ManualFile> manual_of(const CLI::App& program, const std::string& version);

}  // namespace shvr::cli
