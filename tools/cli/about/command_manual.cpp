// shvr manual: writes manual pages and shell completions, for packages. Not listed by --help.

#include <filesystem>

#include "engine/base/atomic_file.h"
#include "tools/cli/about/manual.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

void write_manual(const CLI::App& program, const std::filesystem::path& folder)
{
    for (const ManualFile& file : manual_of(program, SHVR_VERSION)) {
        const std::filesystem::path path = folder / file.path;
        std::error_code error;
        std::filesystem::create_directories(path.parent_path(), error);
        if (error)
            fail(path.parent_path().string(), ": cannot be made (", error.message(),
                 "); expected a folder, or a place where one can be made");
        write_file_atomically(path, std::as_bytes(std::span(file.text)));
    }
}

}  // namespace

void add_manual(CLI::App& program)
{
    auto folder = std::make_shared<std::string>();
    CLI::App* command = program.add_subcommand("manual", "Writes manual pages and shell completions");
    command->group("");
    command->add_option("FOLDER", *folder, "Folder for shared data, as in /usr/share")->required();
    command->callback([folder, &program] { write_manual(program, *folder); });
}

}  // namespace shvr::cli
