#include "tools/cli/cli.h"

#include <cstdlib>
#include <iostream>

#include "engine/annotation/writers/hold.h"
#include "engine/base/image_file.h"
#include "engine/base/text.h"
#include "engine/live/previewer.h"
#include "engine/session/annotation_files.h"
#include "engine/session/kept_settings.h"
#include "engine/session/lasting_settings.h"
#include "engine/session/meshes/session_meshes.h"
#include "engine/tasks/task_options.h"
#include "engine/volume/unit.h"
#include "tools/golden/blessing.h"

namespace shvr::cli {

const char* built_commit();  // in the build folder, by tools/package/write_commit.cmake

namespace {

std::function<void(const Json& result)> prints_taken_by;  ///< empty: standard output

/// Maximum number of MiB: enough for any machine, and small enough that the number of bytes fits into 64 bits.
constexpr int64_t MAX_MIB = int64_t{1} << 24;

CLI::Validator whole_mib()
{
    return {[](std::string& text) {
                const std::optional<int64_t> mib = whole_of(text);
                return mib && *mib >= 1 && *mib <= MAX_MIB
                           ? std::string()
                           : sentence(in_quotes(text), " is given; expected a whole number of MiB from 1 to ", MAX_MIB);
            },
            ""};
}

}  // namespace

std::string version_in_words()
{
    const std::string commit = built_commit();
    return commit.empty() ? SHVR_VERSION : SHVR_VERSION " (" + commit + ")";
}

void add_output_options(CLI::App& command, Common& common)
{
    command.add_flag("--json", common.json, "One JSON object on standard output, nothing else there");
    command.add_flag("--quiet", common.quiet, "No progress on standard error, and no warnings but of what is lost");
}

void add_belief_option(CLI::App& command, Common& common)
{
    command
        .add_option_function<std::string>(
            "--believe",
            [&common](const std::string& value) { common.belief = value == "files" ? Belief::files : Belief::journal; },
            "Where another program has changed saved annotation: the files, as one step that undo takes back, or the "
            "journal")
        ->type_name("files|journal")
        ->check(CLI::IsMember({"files", "journal"}));
}

void add_outside_option(CLI::App& command, Common& common)
{
    command.add_flag("--outside", common.outside,
                     "Write files that the session names outside its own folder; otherwise that is refused");
}

void add_incomplete_option(CLI::App& command, bool& allows_incomplete, const std::string& does)
{
    command.add_flag("--allow-incomplete", allows_incomplete, does);
}

void add_incomplete_option(CLI::App& command, Common& common, const std::string& does)
{
    add_incomplete_option(command, common.allows_incomplete.emplace(false), does);
}

void add_version_option(CLI::App& command, std::optional<OmeZarrVersion>& version, const std::string& otherwise)
{
    std::vector<std::string> names;
    for (const Spelling<OmeZarrVersion>& each : OME_ZARR_VERSIONS) names.emplace_back(each.name);
    const auto take = [&version](const std::string& text) {
        for (const Spelling<OmeZarrVersion>& each : OME_ZARR_VERSIONS)
            if (each.name == text) version = each.value;
    };
    command
        .add_option_function<std::string>("--ome-zarr", take,
                                          "Version of OME-Zarr to write: 0.4 (Zarr 2) or 0.5 (Zarr 3); " + otherwise)
        ->type_name("VERSION")
        ->check(CLI::IsMember(names));
}

void add_input_options(CLI::App& command, Common& common)
{
    command.add_option("--set", common.settings, "Any session key, as in --set render.step_voxels=0.25; repeatable")
        ->type_name("KEY=VALUE")
        ->take_all()
        ->allow_extra_args(false);
    command
        .add_option_function<std::string>(
            "--raw",
            [&common](const std::string& value) {
                parse_raw_layout(value);  // reports a wrong --raw as wrong usage, before it is reported as a bad file
                common.settings.push_back("volume.raw=" + value);
            },
            "How a file of bare voxels is laid out")
        ->type_name("WxHxD:TYPE[:big|little][:OFFSET]");
    // Quotes the value as JSON text, even if it looks like a number.
    const auto text = [&](const char* option, const char* key, const char* form, const char* help) {
        command
            .add_option_function<std::string>(
                option,
                [&common, key](const std::string& value) {
                    common.settings.push_back(sentence(key, "=", Json(value).dump()));
                },
                help)
            ->type_name(form);
    };
    text("--channel", "volume.channel", "NAME|N",
         "What to take from a file with channels: red, green, ... or 1, 2, ...");
    command
        .add_option_function<int>(
            "--level", [&common](int level) { common.settings.push_back(sentence("volume.level=", level)); },
            "Which size to take from a file with several, as a volume of its own: 0 the finest, 1, 2, ...")
        ->type_name("N")
        ->check(CLI::Range(0, 23));
    text("--frame", "volume.frame", "N", "Which time point to take from a file with several: 1, 2, ...");
    add_spacing_options(
        command,
        [&common](const glm::dvec3& spacing) {
            common.settings.push_back(sentence("volume.spacing=[", digits_of(spacing.x), ",", digits_of(spacing.y), ",",
                                               digits_of(spacing.z), "]"));
        },
        [&common](const std::string& unit) { common.settings.push_back("volume.unit=" + Json(unit).dump()); });
    // Bare voxels have no unit. A session would then use "voxel" as the unit by default, which contradicts a spacing.
    command.parse_complete_callback([&common] {
        const auto is_given = [&](std::string_view key) {
            return std::ranges::any_of(common.settings,
                                       [&](const std::string& setting) { return setting.starts_with(key); });
        };
        if (is_given("volume.raw=") && is_given("volume.spacing=") && !is_given("volume.unit="))
            throw UsageError("--spacing is given without a unit; expected --unit, too, as in --unit um");
    });
}

void add_spacing_options(CLI::App& command, const std::function<void(const glm::dvec3&)>& take_spacing,
                         const std::function<void(const std::string&)>& take_unit)
{
    command
        .add_option_function<std::string>(
            "--spacing", [take_spacing](const std::string& text) { take_spacing(parse_spacing(text)); },
            "Size of a voxel: for a file that states none, or instead of what it states")
        ->type_name("X,Y,Z");
    command
        .add_option_function<std::string>(
            "--unit",
            [take_unit](const std::string& text) {
                if (trimmed(text).empty() || has_controls(text))
                    throw UsageError(
                        sentence("--unit is ", in_quotes(text), "; expected the name of a unit, as in um"));
                take_unit(text);
            },
            "Unit of that size, as in um")
        ->type_name("UNIT");
}

void add_host_budget_option(CLI::App& command, Common& common, const std::string& help)
{
    command.add_option("--budget-host", common.budget_host_mib, help)->type_name("MIB")->check(whole_mib());
}

CLI::Validator number_between(double least, double most)
{
    return {[least, most](std::string& text) {
                const std::optional<double> number = number_of(text);
                return number && *number >= least && *number <= most
                           ? std::string()
                           : sentence(in_quotes(text), " is given; expected a number from ", least, " to ", most);
            },
            sentence("FLOAT in [", least, " - ", most, "]")};
}

void add_device_options(CLI::App& command, Common& common)
{
    command.add_option("--device", common.device, "Vulkan device: part of its name, or its index");
    command
        .add_option("--budget-device", common.budget_device_mib,
                    "Device memory SHVR may use, from 16 on, with paint and ambient occlusion from about 19; pictures "
                    "are the same, and faster with more")
        ->type_name("MIB")
        ->check(whole_mib());
    add_host_budget_option(command, common, "Host memory SHVR may use for bricks and transfers");
    add_input_options(command, common);
    command.add_option("--threads", common.threads, "Worker threads; 0: one per core")->check(CLI::Range(0, 1024));
}

void say(const Common& common, const std::string& line)
{
    if (!common.quiet) print_beside_progress(line);
}

void warn(const std::vector<std::string>& warnings, const Common& common)
{
    for (const std::string& warning : warnings) say(common, "warning: " + warning);
}

void warn(const std::vector<Notice>& notices, const Common& common)
{
    for (const Notice& notice : notices)
        if (notice.is_loss)
            warn_of_losses({notice.text});
        else
            say(common, "warning: " + notice.text);
}

void warn_of_losses(const std::vector<std::string>& losses)
{
    for (const std::string& loss : losses) print_beside_progress("warning: " + loss);
}

void warn_of_holder(const std::filesystem::path& journal, const Common& common)
{
    if (const std::optional<Holder> holder = holder_of(journal))
        say(common, sentence("warning: ", journal.string(), ": is open for writing in ", in_words(*holder),
                             "; what is there so far is taken"));
}

void divert_prints(std::function<void(const Json& result)> take)
{
    prints_taken_by = std::move(take);
}

void print(const Json& result)
{
    if (prints_taken_by) return prints_taken_by(result);
    clear_progress();
    std::cout << result.dump(2, ' ', false, Json::error_handler_t::replace) << std::endl;
    if (!std::cout) fail("standard output: cannot be written");
}

glm::uvec2 parse_size(const std::string& text)
{
    const size_t times = text.find('x');
    const auto side = [&](const std::string& digits) {
        const std::optional<int64_t> pixels = whole_of(digits);
        return pixels && *pixels >= 1 && *pixels <= MAX_IMAGE_SIDE ? uint32_t(*pixels) : 0;
    };
    const glm::uvec2 size = times == std::string::npos
                                ? glm::uvec2(0)
                                : glm::uvec2(side(text.substr(0, times)), side(text.substr(times + 1)));
    if (size.x == 0 || size.y == 0)
        throw UsageError(sentence("--size is ", in_quotes(text), "; expected WIDTHxHEIGHT, each from 1 to ",
                                  MAX_IMAGE_SIDE, ", as in 512x384"));
    return size;
}

glm::dvec3 parse_spacing(const std::string& text)
{
    glm::dvec3 spacing{0.0};
    int axis = 0;
    bool fits = true;
    for (std::string_view rest = text; fits; ++axis) {
        const size_t comma = std::min(rest.find(','), rest.size());
        const double side = number_of(rest.substr(0, comma)).value_or(0.0);
        fits = axis < 3 && side >= MIN_SPACING && side <= MAX_SPACING;  // false for NaN
        if (fits) spacing[axis] = side;
        if (comma == rest.size()) break;
        rest.remove_prefix(comma + 1);
    }
    if (!fits || axis != 2)
        throw UsageError(sentence("--spacing is ", in_quotes(text),
                                  "; expected X,Y,Z, the size of a voxel, each above 0, as in 0.8,0.8,1.2"));
    return spacing;
}

namespace {

void take_settings(Session& session, const Work& left, const std::vector<std::string>& overridden)
{
    set_lasting_settings(session, without_overridden(left.settings(), overridden));
    set_kept_settings(session, without_overridden(left.kept_settings(), overridden));
}

/// Reads the session's meshes. A mesh that cannot be read makes the picture another one than the session states.
void show_meshes(Opened& opened, const std::string& path, const Common& common, LongWork& work)
{
    if (opened.session.meshes.empty()) return;
    ReadMeshes read = read_meshes(opened.session, opened.source->info(), opened.renderer->host_budget(),
                                  work.begin("reading meshes of " + path));
    std::vector<std::string> failures;
    for (const auto& [file, failure] : read.failures) failures.push_back(failure);
    if (!failures.empty() && common.allows_incomplete == false) {
        std::string told;
        for (const std::string& failure : failures) told += failure + "; ";
        fail(told, "--allow-incomplete draws the picture without ", failures.size() == 1 ? "it" : "them");
    }
    warn_of_losses(failures);
    warn(read.warnings, common);
    opened.lacks_meshes = !failures.empty();
    for (const auto* const told : {&failures, &read.warnings})
        opened.warnings.insert(opened.warnings.end(), told->begin(), told->end());
    opened.renderer->scene().show_meshes(std::move(read.tree));
}

/// A volume of which parts may be unreadable; owns the sources that `source` refers to.
struct Readable {
    Readable(std::shared_ptr<const VolumeSource> whole, std::shared_ptr<Gaps> what_is_not)
        : base(std::move(whole)), gaps(std::move(what_is_not)), source(*base, *gaps)
    {}
    std::shared_ptr<const VolumeSource> base;
    std::shared_ptr<Gaps> gaps;
    GapSource source;
};

}  // namespace

void check_outside(const std::string& path, const Session& session, const Common& common)
{
    if (common.outside) return;
    const std::filesystem::path file = session_file_of(path);
    const std::string outside = file.empty() ? std::string() : files_outside(session, file, common.settings);
    if (!outside.empty())
        fail(file.string(), ": names files outside its folder: ", outside,
             "; expected files inside it; --outside writes there");
}

Opened open(const std::string& path, const Common& common, LongWork& work, Work::Opening opening,
            const CheckSession& check)
{
    std::unique_ptr<Renderer> renderer;
    const std::shared_ptr<Gaps> gaps(new Gaps(
        common.allows_incomplete ? gaps_of(*common.allows_incomplete, OptionNames::command_line)
                                 : Gaps("shvr import --allow-incomplete makes a project of what can be read")));
    OpeningOptions options{.measure = {.progress = work.begin("opening " + path), .gaps = gaps.get()}};
    options.before_reading = [&](const Session& session, const VolumeSource& source) {
        if (check) check(session, source.info());
        const char* validation = std::getenv("SHVR_VALIDATION");
        renderer = std::make_unique<Renderer>(
            Renderer::Options{.device = {common.device, validation && *validation == '1'},
                              .budget = {common.budget_device_mib << 20, common.budget_host_mib << 20},
                              .threads = common.threads});
        renderer->check_sizes(source, session.render, shows_occlusion(session.light));
        static_cast<void>(work.begin("measuring " + path));
    };
    OpenedSession session = open_session(path, common.settings, options);
    Opened opened{std::move(session.session),
                  std::move(session.source),
                  session.statistics,
                  std::move(session.warnings),
                  std::move(renderer),
                  nullptr,
                  {},
                  gaps};
    for (std::string& removed : session.removed) opened.warnings.push_back(std::move(removed));
    for (const std::string& warning : opened.source->info().warnings) opened.warnings.push_back(warning);
    warn(opened.warnings, common);
    warn_of_losses(session.losses);
    if (opening.only_look) warn_of_holder(opened.session.journal_path, common);
    const auto readable = std::make_shared<Readable>(opened.source, gaps);
    opened.source = std::shared_ptr<const VolumeSource>(readable, &readable->source);
    opened.renderer->load(opened.source, session.statistics, opened.session.render,
                          shows_occlusion(opened.session.light), work.begin("loading " + path));
    warn_of_gaps(opened, path, common);
    opened.annotator = std::make_unique<Annotator>(*opened.renderer);
    opening.belief = common.belief;
    const bool is_picture = !session.pictured.empty();
    const VolumeInfo& volume = opened.source->info();
    opened.project = is_picture ? session.pictured : session_file_of(path);
    Session kept = opened.session;
    choose_thresholds(kept, volume, session.statistics);
    // A picture contains its own settings, on which later changes of the project have no effect.
    const WorkFiles files =
        is_picture ? work_files(opened.session, volume)
                   : with_kept_settings(work_files(opened.session, volume, common.settings), kept, common.settings);
    warn(opened.annotator->open(files, opening), common);
    const Work& left = opened.annotator->work();
    left.expect_choice();
    if (!is_picture) take_settings(opened.session, left, common.settings);
    opened.renderer->scene().show_surfaces(opened.session.surfaces, opened.annotator->document().trace,
                                           opened.session.groups);
    show_meshes(opened, path, common, work);
    return opened;
}

void check_camera(const std::string& name, const Session& session, const VolumeInfo& volume)
{
    std::error_code ignored;
    const bool is_object = trimmed(name).starts_with('{');
    if (name.empty() || (!is_object && std::filesystem::exists(session.journal_path, ignored))) return;
    static_cast<void>(camera_named(session, name, volume));
}

void warn_of_gaps(Opened& opened, const std::string& path, const Common& common)
{
    const std::string words = opened.is_whole() ? std::string() : sentence(path, ": ", opened.gaps->in_words());
    if (words == opened.gaps_told) return;
    std::erase(opened.warnings, opened.gaps_told);
    opened.gaps_told = words;
    opened.warnings.push_back(words);
    warn({words}, common);
}

Json bytes_of(Renderer& renderer)
{
    const gpu::Memory& memory = renderer.memory();
    Json by_resource = Json::object();
    for (const auto& [name, bytes] : memory.bytes_by_name()) by_resource[name] = bytes;
    return {{"device", memory.device_bytes()},
            {"host", renderer.host_bytes()},
            {"peak_device", memory.peak_device_bytes()},
            {"peak_host", renderer.peak_host_bytes()},
            {"by_resource", by_resource}};
}

Json bricks_of(const Renderer& renderer)
{
    const std::optional<DeviceVolume::Counts> counts = renderer.volume().counts();
    if (!counts) return nullptr;
    return {{"slots", counts->slots},
            {"resident", counts->resident},
            {"wanted", counts->reached},
            {"missing", renderer.volume().missing()},
            {"finest_level", renderer.volume().finest_level()},
            {"uploads", counts->uploads},
            {"evictions", counts->evictions},
            {"loads", counts->store.loads},
            {"load_failures", counts->store.failures}};
}

Json counters_of(const std::vector<gpu::PassReport>& passes)
{
    Json counters = Json::object();
    for (const auto& [name, value] : golden::work_of(passes)) counters[name] = value;
    return counters;
}

void check_validation(Opened& opened)
{
    const std::vector<std::string> messages = opened.renderer->device().take_validation_messages();
    if (!messages.empty()) fail(messages.size(), " validation messages, the first: ", messages.front());
}

}  // namespace shvr::cli
