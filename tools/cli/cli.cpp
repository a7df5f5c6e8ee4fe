#include "tools/cli/cli.h"

#include <unistd.h>

#include <cstdlib>
#include <iostream>

#include "engine/base/text.h"
#include "shaders/counters.h"

namespace shvr::cli {

namespace {

/// Enough for any machine, and products with 2^20 fit into 64 bits.
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

void add_output_options(CLI::App& command, Common& common)
{
    command.add_flag("--json", common.json, "One JSON object on standard output, nothing else there");
    command.add_flag("--quiet", common.quiet, "No progress and no warnings on standard error");
}

void add_input_options(CLI::App& command, Common& common)
{
    command.add_option("--set", common.settings, "Any session key, as in --set render.step_voxels=0.25; repeatable")
        ->type_name("KEY=VALUE")
        ->take_all()
        ->allow_extra_args(false);
    const auto shorthand = [&](const char* option, const char* key, const char* form, const char* help) {
        command
            .add_option_function<std::string>(
                option,
                [&common, key](const std::string& value) { common.settings.push_back(sentence(key, "=", value)); },
                help)
            ->type_name(form);
    };
    command
        .add_option_function<std::string>(
            "--raw",
            [&common](const std::string& value) {
                parse_raw_layout(value);  // an error here is wrong usage, not a bad file
                common.settings.push_back("volume.raw=" + value);
            },
            "How a file of bare voxels is laid out")
        ->type_name("WxHxD:TYPE[:big|little][:OFFSET]");
    // Always text, even if it looks like a number.
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
    text("--frame", "volume.frame", "N", "Which point in time to take from a file with several: 1, 2, ...");
    shorthand("--unit", "volume.unit", "UNIT", "Unit of --spacing, as in um");
    command
        .add_option_function<std::string>(
            "--spacing",
            [&common](const std::string& value) { common.settings.push_back("volume.spacing=[" + value + "]"); },
            "Size of a voxel of --raw")
        ->type_name("X,Y,Z");
}

void add_device_options(CLI::App& command, Common& common)
{
    command.add_option("--device", common.device, "Vulkan device: part of its name, or its index");
    command.add_option("--budget-device", common.budget_device_mib, "Device memory SHVR may use")
        ->type_name("MIB")
        ->check(whole_mib());
    command.add_option("--budget-host", common.budget_host_mib, "Host memory SHVR may use for bricks and transfers")
        ->type_name("MIB")
        ->check(whole_mib());
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

void print(const Json& result)
{
    clear_progress();
    std::cout << result.dump(2, ' ', false, Json::error_handler_t::replace) << std::endl;
    if (!std::cout) fail("standard output: cannot be written");
}

void check_output(const char* option, const std::string& path, const std::vector<std::string>& extensions)
{
    if (path.empty()) return;
    const std::string extension = lower_case(std::filesystem::path(path).extension().string());
    if (std::ranges::find(extensions, extension) == extensions.end()) {
        std::string all;
        for (const std::string& known : extensions) all += (all.empty() ? "" : ", ") + known;
        throw UsageError(sentence(option, " is '", path, "'; expected a name that ends in one of: ", all));
    }
    const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored))
        fail(path, ": cannot be written: there is no folder ", folder.string());
    if (::access(folder.c_str(), W_OK | X_OK) != 0)
        fail(path, ": cannot be written: the folder ", folder.string(), " may not be written to");
    if (std::filesystem::is_directory(path, ignored)) fail(path, ": is a folder; expected the name of a file");
}

glm::uvec2 parse_size(const std::string& text)
{
    unsigned width = 0, height = 0;
    char end = 0;
    if (std::sscanf(text.c_str(), "%ux%u%c", &width, &height, &end) != 2 || width < 1 || height < 1 || width > 16384 ||
        height > 16384)
        throw UsageError(sentence("--size is '", text, "'; expected WIDTHxHEIGHT, each 1 ... 16384, as in 512x384"));
    return {width, height};
}

Opened open(const std::string& path, const Common& common, LongWork& work, Work::Start start)
{
    std::unique_ptr<Renderer> renderer;
    OpeningOptions opening{.measure = {.progress = work.begin("opening " + path)}};
    opening.before_reading = [&](const Session& session, const VolumeSource& source) {
        const char* validation = std::getenv("SHVR_VALIDATION");
        renderer = std::make_unique<Renderer>(
            Renderer::Options{.device = {common.device, validation && *validation == '1'},
                              .budget = {common.budget_device_mib << 20, common.budget_host_mib << 20},
                              .threads = common.threads});
        renderer->check_sizes(source, session.render, shows_occlusion(session.light));
        static_cast<void>(work.begin("measuring " + path));
    };
    OpenedSession session = open_session(path, common.settings, opening);
    Opened opened{std::move(session.session), std::move(session.source), std::move(session.warnings),
                  std::move(renderer), nullptr};
    for (const std::string& warning : opened.source->info().warnings) opened.warnings.push_back(warning);
    warn(opened.warnings, common);
    opened.renderer->load(opened.source, session.statistics, opened.session.render,
                          shows_occlusion(opened.session.light), work.begin("loading " + path));
    opened.annotator = std::make_unique<Annotator>(*opened.renderer);
    warn(opened.annotator->open(work_files(opened.session, opened.source->info()), start), common);
    opened.renderer->scene().show_surfaces(opened.session.surfaces, opened.annotator->document().trace,
                                           opened.session.groups);
    return opened;
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
    const std::pair<uint32_t, const char*> names[] = {{gpu::COUNTER_RAYS, "rays"},
                                                      {gpu::COUNTER_SAMPLES, "samples"},
                                                      {gpu::COUNTER_SHADED, "shaded_samples"},
                                                      {gpu::COUNTER_LEAPS, "leaps"},
                                                      {gpu::COUNTER_BRICKS_VISITED, "bricks_visited"},
                                                      {gpu::COUNTER_BRICKS_SKIPPED, "bricks_skipped"},
                                                      {gpu::COUNTER_TERMINATED, "rays_terminated_early"}};
    Json counters = Json::object();
    for (const auto& [index, name] : names) {
        uint64_t sum = 0;
        for (const gpu::PassReport& pass : passes)
            if (!pass.counters.empty()) sum += pass.counters[index];
        counters[name] = sum;
    }
    return counters;
}

void check_validation(Opened& opened)
{
    const std::vector<std::string> messages = opened.renderer->device().take_validation_messages();
    if (!messages.empty()) fail(messages.size(), " validation messages, the first: ", messages.front());
}

}  // namespace shvr::cli
