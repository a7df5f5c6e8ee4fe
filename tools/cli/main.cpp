// shvr: one binary, a sub-command for each thing it does.

#include <cstdio>
#include <exception>
#include <new>

#include "tools/cli/cli.h"

namespace {

enum Exit { done = 0, world = 1, usage = 2, gate = 3 };

int run(int argc, char** argv)
{
    CLI::App program("SHVR: see, feel and annotate tubular structures in 3-D scans", "shvr");
    program.require_subcommand(1);
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
    shvr::cli::add_phantom(program);
    shvr::cli::add_view(program);
    try {
        char view[] = "view";
        char* alone[] = {argv[0], view};
        if (argc == 1)
            program.parse(2, alone);
        else
            program.parse(argc, argv);  // runs the command's callback
    } catch (const CLI::ParseError& error) {
        return program.exit(error) == 0 ? Exit::done : Exit::usage;
    }
    return Exit::done;
}

int report(const char* message, Exit status)
{
    std::fprintf(stderr, "shvr: %s\n", message);
    return status;
}

}  // namespace

int main(int argc, char** argv)
{
    try {
        return run(argc, argv);
    } catch (const shvr::UsageError& error) {
        return report(error.what(), Exit::usage);
    } catch (const shvr::GateError& error) {
        return report(error.what(), Exit::gate);
    } catch (const std::bad_alloc&) {
        return report("host memory is exhausted", Exit::world);
    } catch (const std::exception& error) {
        return report(error.what(), Exit::world);
    }
}
