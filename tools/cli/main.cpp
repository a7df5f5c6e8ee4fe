// shvr: one binary with a sub-command for each task.

#include <malloc.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "engine/base/machine/machine.h"
#include "engine/base/text.h"
#include "engine/remote/address.h"
#include "tools/cli/array/ranks_job.h"
#include "tools/cli/array/split_job.h"
#include "tools/cli/cli.h"
#include "tools/cli/stop.h"

namespace {

enum Exit { done = 0, world = 1, usage = 2, gate = 3 };

/// CLI11's message on one line.
std::string usage_error(const CLI::App& program, const CLI::ParseError& error)
{
    std::string command = "shvr", text = error.what();
    for (const CLI::App* chosen : program.get_subcommands()) command += " " + chosen->get_name();
    std::ranges::replace(text, '\n', ' ');
    return text + "; see " + command + " --help";
}

/// Returns the error message for a first argument that is not a command.
std::string no_command(const CLI::App& program, const std::string& found)
{
    std::string known;
    for (const CLI::App* command :
         program.get_subcommands([](const CLI::App* each) { return !each->get_group().empty(); }))
        known += (known.empty() ? "" : ", ") + command->get_name();
    return shvr::in_quotes(found) + (found.starts_with('-') ? " is an unknown option" : " is an unknown command") +
           "; expected one of " + known + "; see shvr --help";
}

/// Refuses empty options and names: if a variable in a script is unset, the script would use the wrong files.
void refuse_empty(int argc, char** argv)
{
    for (int i = 1; i < argc; ++i) {
        const std::string_view argument = argv[i], before = i > 1 ? argv[i - 1] : "";
        const bool is_empty_option =
            argument.starts_with("--") && argument.find('=') == argument.size() - 1;  // --output=
        if (!argument.empty() && !is_empty_option) continue;
        if (is_empty_option)
            throw shvr::UsageError(
                shvr::sentence(argument.substr(0, argument.size() - 1), " is empty; expected a value"));
        const std::string named = shvr::take_query(std::string(before));
        throw shvr::UsageError(shvr::sentence("argument ", i, named.empty() ? "" : ", after ", named,
                                              named.empty() ? "" : ",", " is empty; expected a name or a value"));
    }
}

/// Removes the query parts of URLs, which are credentials, from the arguments, and stores them separately: arguments
/// may be printed or stored later.
std::vector<std::string> without_queries(int argc, char** argv)
{
    constexpr std::string_view SETTING = "volume.path=";
    std::vector<std::string> arguments;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        const size_t setting = argument.find(SETTING);
        const size_t begin = setting == std::string::npos ? 0 : setting + SETTING.size();
        arguments.push_back(argument.substr(0, begin) + shvr::take_query(argument.substr(begin)));
    }
    std::ranges::reverse(arguments);  // the order in which CLI11 takes them
    return arguments;
}

void add_commands(CLI::App& program)
{
    program.require_subcommand(1);
    const std::string version = "shvr " + shvr::cli::version_in_words();
    program.set_version_flag("--version", version);
    program.footer("shvr alone opens the window. shvr COMMAND --help shows options and an example.");
    shvr::cli::add_info(program);
    shvr::cli::add_import(program);
    shvr::cli::add_render(program);
    shvr::cli::add_annotate(program);
    shvr::cli::add_export(program);
    shvr::cli::add_evaluate(program);
    shvr::cli::add_label(program);
    shvr::cli::add_compare(program);
    shvr::cli::add_profile(program);
    shvr::cli::add_golden(program);
    shvr::cli::add_bench(program);
    shvr::cli::add_phantom(program);
    shvr::cli::add_study(program);
    shvr::cli::add_gather(program);
    shvr::cli::add_haptics(program);
    shvr::cli::add_doctor(program);
    shvr::cli::add_view(program);
    shvr::cli::add_manual(program);
    for (CLI::App* command : program.get_subcommands({})) command->set_version_flag("--version", version);
}

constexpr const char* DESCRIPTION = "SHVR: see, feel and annotate tubular structures in 3-D scans";

int run(int argc, char** argv)
{
    CLI::App program(DESCRIPTION, "shvr");
    add_commands(program);
    refuse_empty(argc, argv);
    try {
        std::vector<std::string> arguments = without_queries(argc, argv);
        if (arguments.empty()) arguments.emplace_back("view");
        shvr::cli::note_arguments({arguments.rbegin(), arguments.rend()});
        program.parse(std::move(arguments));  // runs the command's callback
    } catch (const CLI::Success& asked) {     // --help, --version
        return program.exit(asked);
    } catch (const CLI::ParseError& error) {
        if (program.get_subcommands().empty()) throw shvr::UsageError(no_command(program, argv[1]));
        throw shvr::UsageError(usage_error(program, error));
    }
    return Exit::done;
}

/// Returns " while loading scan.nrrd", or an empty text if no long work has begun.
std::string while_doing()
{
    const std::string what = shvr::cli::last_begun();
    return what.empty() ? what : " while " + what;
}

void report(const char* message)
{
    // Replaces control characters: arguments and files may contain terminal escape sequences.
    std::fprintf(stderr, "shvr: %s\n", shvr::printable(message).c_str());
}

/// Makes malloc return large freed blocks to the system. By default glibc raises its mmap threshold up to 32 MiB, and
/// the holes that growing lists (the surfaces of a trace) leave in the heap cannot be reused: 115 MB at 40,000 nodes.
void keep_heap_compact()
{
    static_cast<void>(::mallopt(M_MMAP_THRESHOLD, 1 << 20));
    // Setting one threshold fixes the other at 128 KiB: zstd and Blosc, which allocate for every chunk, would then give
    // their memory back after each and take a page fault for every page of it (engine/projects/MEASURED.md).
    static_cast<void>(::mallopt(M_TRIM_THRESHOLD, 2 << 20));
}

/// Makes lavapipe start as many threads as the job was given: it heeds affinity, but no control groups.
void limit_lavapipe()
{
    const int allowed = shvr::processors_allowed();
    if (allowed < int(std::thread::hardware_concurrency()))
        static_cast<void>(::setenv("LP_NUM_THREADS", std::to_string(allowed).c_str(), 0));
}

struct Outcome {
    Exit status = Exit::done;
    std::string message{};  ///< empty: the command did not fail
};
/// Runs the command.
Outcome outcome_of(int argc, char** argv)
{
    try {
        return {Exit(run(argc, argv))};
    } catch (const shvr::UsageError& error) {
        return {Exit::usage, error.what()};
    } catch (const shvr::GateError& error) {
        return {Exit::gate, error.what()};
    } catch (const shvr::Disputed& error) {
        return {Exit::world, shvr::sentence(error.what(),
                                            "; both are kept; answer with --believe files, to take what is in the file "
                                            "as a step that undo takes back, or --believe journal, with which the "
                                            "next save keeps the file under another name")};
    } catch (const shvr::JournalTaken& error) {
        return {Exit::world,
                shvr::sentence(error.what(), "; shvr view looks at it meanwhile and shvr export copies it")};
    } catch (const std::bad_alloc&) {
        return {Exit::world,
                shvr::sentence("host memory is exhausted", while_doing(), ", with ", shvr::cli::peak_mebibytes(),
                               " MiB in use; expected more, or less to hold: --budget-host bounds what a paged "
                               "volume takes, shvr import --downscale or --crop makes it smaller")};
    } catch (const std::system_error& error) {
        if (error.code() != std::errc::resource_unavailable_try_again) return {Exit::world, error.what()};
        return {Exit::world,
                shvr::sentence("no further thread can be started", while_doing(), " (", error.what(),
                               "); expected a higher limit of processes (ulimit -u) or of memory (ulimit -v), "
                               "or fewer threads: --threads 1")};
    } catch (const std::exception& error) {
        return {Exit::world, error.what()};
    }
}

}  // namespace

namespace shvr::cli {

void parse_and_run(const std::vector<std::string>& arguments)
{
    CLI::App program(DESCRIPTION, "shvr");
    add_commands(program);
    note_arguments(arguments);
    try {
        program.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::ParseError& error) {
        throw UsageError(usage_error(program, error));
    }
}

}  // namespace shvr::cli

int main(int argc, char** argv)
{
    keep_heap_compact();
    limit_lavapipe();
    shvr::cli::open_standard_streams();
    shvr::cli::silence_other_ranks(argc, argv);
    shvr::cli::end_in_words();
    const Outcome outcome = outcome_of(argc, argv);
    if (!outcome.message.empty()) report(outcome.message.c_str());
    return shvr::cli::leave_ranks(outcome.message) ? outcome.status : Exit::done;
}
