// shvr annotate: replays a script of annotation commands.

#include <concepts>

#include "engine/annotation/trace/trace_command.h"
#include "engine/annotation/work/script.h"
#include "engine/session/label_looks.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

struct AnnotateCommandOptions {
    Common common;
    std::string project, script;
    bool fresh = false;
};

class Replay {
public:
    Replay(Opened& opened_session, const AnnotateCommandOptions& given) : opened(opened_session), options(given) {}

    Opened& opened;
    const AnnotateCommandOptions& options;
    int64_t voxels_changed = 0;
    std::string at;  ///< "file:line"

private:
    const TraceGraph& trace() const { return opened.annotator->document().trace; }

    /// Returns the result of `act`; its errors name the line.
    template <class Act>
    auto in_words(const Act& act) const
    {
        try {
            return act();
        } catch (const Error& error) {
            fail(at, ": ", error.what());
        }
    }

public:
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
    template <class Op>
    requires std::constructible_from<TraceOp, Op>
    void operator()(const Op& op)
    {
        const ProbeSettings& probe = opened.session.probe;
        TraceEffect effect = in_words([&] {
            const BrushSettings& brush = probe.brush;
            return effect_of(op, trace(), {opened.source->info().spacing, brush.radius_voxels, brush.group});
        });
        if (effect.selection)
            opened.annotator->work().select_trace(std::move(*effect.selection));
        else
            opened.annotator->edit_trace(std::move(effect.label), std::move(effect.changes));
        if constexpr (std::same_as<Op, NodeOp>) {
            const uint32_t number = trace().selection().node().value();
            say(options.common, sentence(at, ": node ", number, " in group ", int(trace().node(number).group)));
        }
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
        const auto save = [&] {
            return opened.annotator->work().save(label_looks(opened.session.groups, opened.annotator->document().mask));
        };
        for (const std::filesystem::path& path : in_words(save))
            say(options.common, sentence(at, ": saved ", path.string()));
    }
    void operator()(const ExpectOp& op)
    {
        const std::array<int64_t, 256> counts = opened.annotator->document().mask.voxels_by_group();
        for (const auto& [group, voxels] : op.voxels_in_group)
            if (counts[group] != voxels)
                throw GateError(
                    sentence(at, ": group ", int(group), " has ", counts[group], " voxels; expected ", voxels));
        const std::tuple<const char*, std::optional<int64_t>, size_t> traced[] = {
            {"nodes", op.nodes, trace().nodes().size()}, {"internodes", op.internodes, trace().internodes().size()}};
        for (const auto& [what, expected, found] : traced)
            if (expected && *expected != int64_t(found))
                throw GateError(sentence(at, ": ", found, " ", what, "; expected ", *expected));
        const int64_t raised = opened.annotator->document().density.voxels();
        if (op.voxels_with_offset.value_or(raised) != raised)
            throw GateError(sentence(at, ": ", raised, " voxels have an offset; expected ", *op.voxels_with_offset));
    }
};

void run_annotate(const AnnotateCommandOptions& options)
{
    const std::vector<ScriptLine> script = read_script(options.script);
    LongWork work(options.common.quiet);
    Opened opened =
        open(options.project, options.common, work, options.fresh ? Work::Start::fresh : Work::Start::as_left);
    const VolumeInfo& volume = opened.source->info();
    for (const ScriptLine& line : script)  // before anything is painted
        if (const auto* paint = std::get_if<PaintOp>(&line.op)) try {
                check_radius(paint->radius_voxels, volume.spacing, volume.size);
            } catch (const Error& error) {
                fail(options.script, ":", line.number, ": ", error.what());
            }
    Replay replay{opened, options};
    const Progress progress = work.begin("replaying " + options.script);
    for (size_t i = 0; i < script.size(); ++i) {
        tell(progress, double(i) / double(script.size()));
        replay.at = sentence(options.script, ":", script[i].number);
        std::visit(replay, script[i].op);
    }
    opened.annotator->work().flush();
    check_validation(opened);
    if (options.common.json)
        print({{"commands", script.size()},
               {"voxels_changed", replay.voxels_changed},
               {"nodes", opened.annotator->document().trace.nodes().size()},
               {"internodes", opened.annotator->document().trace.internodes().size()},
               {"journal_bytes", opened.annotator->work().journal().bytes}});
}

}  // namespace

void add_annotate(CLI::App& program)
{
    auto options = std::make_shared<AnnotateCommandOptions>();
    CLI::App* command = program.add_subcommand("annotate", "Runs annotation commands from a script");
    command->add_option("PROJECT", options->project, "Project folder or session (.json)")->required();
    command->add_option("--script", options->script, "Commands, one JSON object a line")->required();
    command->add_flag("--fresh", options->fresh,
                      "Start without the existing annotation; its journal is kept as JOURNAL.old");
    add_device_options(*command, options->common);
    add_output_options(*command, options->common);
    command->footer(
        "Example:\n  shvr annotate scan/ --script strokes.jsonl\nwith lines such as\n"
        "  {\"op\":\"paint\",\"brush\":\"flood\",\"region\":\"ball\",\"group\":1,\"threshold\":1200,\"radius\":8,"
        "\"path\":[[40,52,18],[41,53,30]]}\n  {\"op\":\"node\",\"at\":[40,52,18],\"radius\":3,\"group\":2}\n"
        "  {\"op\":\"density\",\"brush\":\"flood\",\"threshold\":900,\"offset\":\"automatic\",\"falloff\":"
        "\"distance\",\"radius\":8,\"path\":[[40,52,18]]}\n  {\"op\":\"undo\",\"count\":1}\n  {\"op\":\"save\"}");
    command->callback([options] { run_annotate(*options); });
}

}  // namespace shvr::cli
