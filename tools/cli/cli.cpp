#include "tools/cli/cli.h"

#include <cstdlib>
#include <iostream>

#include "engine/live/trace_look.h"
#include "shaders/counters.h"

namespace shvr::cli {

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
    shorthand("--raw", "volume.raw", "WxHxD:TYPE[:big|little][:OFFSET]", "How a file of bare voxels is laid out");
    // Text, also where it looks like a number.
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
    command.add_option("--budget-device", common.budget_device_mib, "Device memory SHVR may use")->type_name("MIB");
    command.add_option("--budget-host", common.budget_host_mib, "Host memory SHVR may use for bricks and transfers")
        ->type_name("MIB");
    add_input_options(command, common);
    command.add_option("--threads", common.threads, "Worker threads; 0: one per core")->check(CLI::Range(0, 1024));
}

void say(const Common& common, const std::string& line)
{
    if (!common.quiet) std::cerr << line << '\n';
}

void warn(const std::vector<std::string>& warnings, const Common& common)
{
    for (const std::string& warning : warnings) say(common, "warning: " + warning);
}

void print(const Json& result)
{
    std::cout << result.dump(2, ' ', false, Json::error_handler_t::replace) << std::endl;
    if (!std::cout) fail("standard output: cannot be written");
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

Opened open(const std::string& path, const Common& common, Work::Start start)
{
    OpenedSession session = open_session(path, common.settings);
    Opened opened{std::move(session.session), std::move(session.source), std::move(session.warnings), nullptr, nullptr};
    for (const std::string& warning : opened.source->info().warnings) opened.warnings.push_back(warning);
    warn(opened.warnings, common);

    const char* validation = std::getenv("SHVR_VALIDATION");
    opened.renderer = std::make_unique<Renderer>(
        Renderer::Options{.device = {common.device, validation && *validation == '1'},
                          .budget = {common.budget_device_mib << 20, common.budget_host_mib << 20},
                          .threads = common.threads});
    opened.renderer->load(opened.source, session.statistics, opened.session.render,
                          shows_occlusion(opened.session.light));
    opened.annotator = std::make_unique<Annotator>(*opened.renderer);
    warn(opened.annotator->open(work_files(opened.session, opened.source->info()), start), common);
    show_surfaces(*opened.renderer, opened.session.surfaces, opened.annotator->document().trace, opened.session.groups);
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
    if (!renderer.paged()) return nullptr;
    const PagedVolume::Counts counts = renderer.paged()->counts();
    return {{"slots", counts.slots},
            {"resident", counts.resident},
            {"wanted", counts.reached},
            {"missing", renderer.paged()->missing()},
            {"finest_level", renderer.paged()->tree() ? renderer.paged()->tree()->finest_level : 0},
            {"uploads", counts.uploads},
            {"evictions", counts.evictions},
            {"loads", counts.store.loads},
            {"load_failures", counts.store.failures}};
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
