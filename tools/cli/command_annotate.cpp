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
        const PaintOp chosen = with_offset(op, opened.session.transfer_function);
        const int64_t voxels = opened.annotator->paint(chosen);
        voxels_changed += voxels;
        if (!chosen.density)
            say(options.common, sentence(at, ": ", voxels, " voxels painted in group ", int(op.group)));
        else
            say(options.common,
                sentence(at, ": ", voxels, " changes of offsets", chosen.paints_group ? " and groups" : "",
                         ", by at most ", *chosen.density->offset));
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
        const std::filesystem::path &mask = opened.session.mask_path, &density = opened.session.density_path;
        if (mask.empty()) fail(at, ": the session names no mask to save to; expected the key annotation.mask");
        if (density.empty() && opened.annotator->document().density.voxels() > 0)
            fail(at, ": the session names no file for density offsets; expected the key annotation.density");
        opened.annotator->save(mask);
        say(options.common, sentence(at, ": saved ", mask.string()));
        if (density.empty()) return;
        opened.annotator->save_offsets(density);
        say(options.common, sentence(at, ": saved ", density.string()));
    }
    void operator()(const ExpectOp& op)
    {
        const std::array<int64_t, 256> counts = opened.annotator->document().mask.voxels_by_group();
        for (const auto& [group, voxels] : op.voxels_in_group)
            if (counts[group] != voxels)
                throw GateError(
                    sentence(at, ": group ", int(group), " has ", counts[group], " voxels; expected ", voxels));
        const int64_t raised = opened.annotator->document().density.voxels();
        if (op.voxels_with_offset.value_or(raised) != raised)
            throw GateError(sentence(at, ": ", raised, " voxels have an offset; expected ", *op.voxels_with_offset));
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
    command->add_flag("--fresh", options->fresh, "Start without paint and offsets instead of the saved ones");
    add_device_options(*command, options->common);
    add_output_options(*command, options->common);
    command->footer(
        "Example:\n  shvr annotate scan/ --script strokes.jsonl\nwith lines such as\n"
        "  {\"op\":\"paint\",\"brush\":\"flood\",\"region\":\"ball\",\"group\":1,\"threshold\":1200,\"radius\":8,"
        "\"path\":[[40,52,18],[41,53,30]]}\n  "
        "{\"op\":\"density\",\"brush\":\"flood\",\"threshold\":900,\"offset\":\"automatic\",\"falloff\":"
        "\"distance\",\"radius\":8,\"path\":[[40,52,18]]}\n  {\"op\":\"undo\",\"count\":1}\n  {\"op\":\"save\"}");
    command->callback([options] { run(*options); });
}

}  // namespace shvr::cli
