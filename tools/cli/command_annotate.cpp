// shvr annotate: replays a script of annotation commands.

#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

struct Options {
    Common common;
    std::string project, script;
    bool fresh = false;
};

struct Replay {
    Opened& opened;
    const Options& options;
    int64_t voxels_changed = 0;
    std::string at;  ///< "file:line"

    void operator()(const PaintOp& op)
    {
        const int64_t voxels = opened.annotator->paint(op);
        voxels_changed += voxels;
        say(options.common, sentence(at, ": ", voxels, " voxels painted in group ", int(op.group)));
    }
    void operator()(const UndoOp& op)
    {
        for (int i = 0; i < op.count; ++i)
            if (!opened.annotator->undo()) fail(at, ": undo ", i + 1, " of ", op.count, ": nothing is left to undo");
    }
    void operator()(const RedoOp& op)
    {
        for (int i = 0; i < op.count; ++i)
            if (!opened.annotator->redo()) fail(at, ": redo ", i + 1, " of ", op.count, ": nothing is left to redo");
    }
    void operator()(const SaveOp&)
    {
        const std::filesystem::path& path = opened.session.mask_path;
        if (path.empty()) fail(at, ": the session names no mask to save to; expected the key annotation.mask");
        opened.annotator->save(path, opened.session.volume_hash);
        say(options.common, sentence(at, ": saved ", path.string()));
    }
    void operator()(const ExpectOp& op)
    {
        const std::array<int64_t, 256> counts = opened.annotator->document().mask.voxels_by_group();
        for (const auto& [group, voxels] : op.voxels_in_group)
            if (counts[group] != voxels)
                throw GateError(
                    sentence(at, ": group ", int(group), " has ", counts[group], " voxels; expected ", voxels));
        const std::pair<const char*, std::optional<int64_t>> traced[] = {{"nodes", op.nodes},
                                                                         {"internodes", op.internodes}};
        for (const auto& [what, expected] : traced)
            if (expected.value_or(0) != 0) throw GateError(sentence(at, ": 0 ", what, "; expected ", *expected));
    }
};

void run(const Options& options)
{
    const std::vector<ScriptLine> script = read_script(options.script);
    Opened opened = open(options.project, options.common, !options.fresh);
    const VolumeInfo& volume = opened.source->info();
    for (const ScriptLine& line : script)  // before anything is painted
        if (const auto* paint = std::get_if<PaintOp>(&line.op)) try {
                check_radius(paint->radius_voxels, volume.spacing, volume.size);
            } catch (const Error& error) {
                fail(options.script, ":", line.number, ": ", error.what());
            }
    Replay replay{.opened = opened, .options = options};
    for (const ScriptLine& line : script) {
        replay.at = sentence(options.script, ":", line.number);
        std::visit(replay, line.op);
    }
    check_validation(opened);
    if (options.common.json)
        print({{"commands", script.size()},
               {"voxels_changed", replay.voxels_changed},
               {"nodes", 0},
               {"internodes", 0},
               {"journal_bytes", 0}});
}

}  // namespace

void add_annotate(CLI::App& program)
{
    auto options = std::make_shared<Options>();
    CLI::App* command = program.add_subcommand("annotate", "Replays annotation commands");
    command->add_option("PROJECT", options->project, "Project folder or session (.json)")->required();
    command->add_option("--script", options->script, "Commands, one JSON object a line")->required();
    command->add_flag("--fresh", options->fresh, "Start from an unpainted mask instead of the saved one");
    add_device_options(*command, options->common);
    add_output_options(*command, options->common);
    command->footer(
        "Example:\n  shvr annotate scan/ --script strokes.jsonl\nwith lines such as\n"
        "  {\"op\":\"paint\",\"brush\":\"flood\",\"region\":\"ball\",\"group\":1,\"threshold\":1200,\"radius\":8,"
        "\"path\":[[40,52,18],[41,53,30]]}\n  {\"op\":\"undo\",\"count\":1}\n  {\"op\":\"save\"}");
    command->callback([options] { run(*options); });
}

}  // namespace shvr::cli
