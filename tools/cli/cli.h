#pragma once
// Shared by the sub-commands of `shvr`: common options, opening a session with a renderer, and printing results. Each
// command is one file with a function that adds the command to the program; main.cpp lists these functions.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "engine/live/annotator.h"
#include "engine/projects/import_volume.h"
#include "engine/session/session.h"
#include "engine/tasks/task_output.h"
#include "engine/volume/gaps.h"
#include "tools/cli/long_work.h"

namespace shvr::cli {

using Json = nlohmann::ordered_json;

/// "0.1.0 (f3c3aac1d2e4)", or "0.1.0" if the program was built from sources without their git history.
std::string version_in_words();

struct Common {
    std::string device;
    uint64_t budget_device_mib = 0;
    uint64_t budget_host_mib = 0;
    std::vector<std::string> settings;
    int threads = 0;
    bool quiet = false;
    bool json = false;
    std::optional<bool> allows_incomplete;  ///< null: the command has no --allow-incomplete
    Belief belief = Belief::ask;
    bool outside = false;  ///< the session may write files outside its folder
};

/// --set, --raw, --spacing, --unit
void add_input_options(CLI::App& command, Common& common);
/// Adds only --spacing and --unit, for commands that read volumes without a session. Refuses impossible values.
void add_spacing_options(CLI::App& command, const std::function<void(const glm::dvec3&)>& take_spacing,
                         const std::function<void(const std::string&)>& take_unit);
/// Adds the input options, and also --device, --budget-device, --budget-host and --threads.
void add_device_options(CLI::App& command, Common& common);
/// --budget-host
void add_host_budget_option(CLI::App& command, Common& common, const std::string& help);
/// Checks that an option is a number in this range; unlike CLI::Range, it refuses NaN.
CLI::Validator number_between(double least, double most);
/// Adds --ome-zarr, the version of the format to write; null if the option is not given.
void add_version_option(CLI::App& command, std::optional<OmeZarrVersion>& version, const std::string& otherwise);
/// --believe, for commands that open annotation.
void add_belief_option(CLI::App& command, Common& common);
/// Adds --outside, for commands that write the files that a session names, wherever they are.
void add_outside_option(CLI::App& command, Common& common);
/// Fails if the session would write outside its folder and --outside is not given. `path`: the opened file.
void check_outside(const std::string& path, const Session& session, const Common& common);
/// Adds --allow-incomplete, for commands whose result needs all voxels.
void add_incomplete_option(CLI::App& command, bool& allows_incomplete, const std::string& does);
void add_incomplete_option(CLI::App& command, Common& common, const std::string& does);
/// --json, --quiet: every command has them.
void add_output_options(CLI::App& command, Common& common);

/// Prints a line on standard error, unless --quiet is given.
void say(const Common& common, const std::string& line);
void warn(const std::vector<std::string>& warnings, const Common& common);
/// Prints notices about annotation that was opened; data losses are printed even with --quiet.
void warn(const std::vector<Notice>& notices, const Common& common);
/// Printed even with --quiet.
void warn_of_losses(const std::vector<std::string>& losses);
/// Warns if another process is writing the journal, since records that it has not written yet are not visible here.
void warn_of_holder(const std::filesystem::path& journal, const Common& common);
/// Prints one object on standard output.
void print(const Json& result);
/// From now on `print` passes its objects to `take` instead; empty: prints again.
void divert_prints(std::function<void(const Json& result)> take);
/// "0.8,0.8,1.2"
glm::dvec3 parse_spacing(const std::string& text);
/// "512x384"
glm::uvec2 parse_size(const std::string& text);

/// An open session, with its volume on the device and its mask and trace, if any, loaded. It is read-only unless
/// `opening` holds the journal's lock or the session has no journal.
struct Opened {
    Session session;
    std::shared_ptr<const VolumeSource> source;
    VolumeStatistics statistics;
    std::vector<std::string> warnings;
    std::unique_ptr<Renderer> renderer;
    std::unique_ptr<Annotator> annotator;
    std::filesystem::path project;     ///< file of the opened session; empty for a bare volume
    std::shared_ptr<const Gaps> gaps;  ///< unreadable parts found so far; bricks are read while drawing
    std::string gaps_told{};           ///< already printed by `warn_of_gaps`

    bool lacks_meshes = false;  ///< a mesh of the session cannot be shown

    bool is_whole() const { return gaps->empty(); }
    /// Whether pictures can show all that the session states.
    bool is_complete() const { return is_whole() && !lacks_meshes; }
    int64_t voxels_not_read() const { return gaps->voxels(); }
};
/// Before reading voxels, refuses volumes that exceed the budgets.
/// Refuses unreadable volumes unless `common.allows_incomplete` is
/// set. `check` may refuse a session before its voxels are read.
using CheckSession = std::function<void(const Session& session, const VolumeInfo& volume)>;
Opened open(const std::string& path, const Common& common, LongWork& work, Work::Opening opening = {.only_look = true},
            const CheckSession& check = {});
/// Fails if no camera has that name, unless a journal exists, which may hold more cameras. Empty: the session's camera.
void check_camera(const std::string& name, const Session& session, const VolumeInfo& volume);
/// Warns about parts newly found unreadable since the last call: drawing reads bricks, so it can discover more.
void warn_of_gaps(Opened& opened, const std::string& path, const Common& common);

/// {device, host, by_resource}
Json bytes_of(Renderer& renderer);
/// Returns the numbers of loaded and evicted bricks; null if the volume is not paged.
Json bricks_of(const Renderer& renderer);
/// Returns work counters by name, summed over the passes.
Json counters_of(const std::vector<gpu::PassReport>& passes);

/// If the Khronos validation layer is on (SHVR_VALIDATION=1) and has reported anything, fails with the first report.
void check_validation(Opened& opened);

void add_doctor(CLI::App& program);
void add_info(CLI::App& program);
void add_manual(CLI::App& program);  ///< not listed by --help
void add_import(CLI::App& program);
void add_render(CLI::App& program);
void add_annotate(CLI::App& program);
void add_export(CLI::App& program);
void add_evaluate(CLI::App& program);
void add_label(CLI::App& program);
void add_compare(CLI::App& program);
void add_profile(CLI::App& program);
void add_phantom(CLI::App& program);
void add_study(CLI::App& program);
void add_golden(CLI::App& program);
void add_gather(CLI::App& program);
void add_bench(CLI::App& program);
void add_view(CLI::App& program);
void add_haptics(CLI::App& program);

}  // namespace shvr::cli
