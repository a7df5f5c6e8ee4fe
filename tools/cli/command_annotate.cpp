// shvr annotate: replays a script of annotation commands.

#include "engine/annotation/trace_edit.h"
#include "tools/cli/cli.h"

namespace shvr::cli {

namespace {

struct Options {
    Common common;
    std::string project, script;
    bool fresh = false;
};

class Replay {
public:
    Replay(Opened& opened_session, const Options& given) : opened(opened_session), options(given) {}

    Opened& opened;
    const Options& options;
    int64_t voxels_changed = 0;
    std::string at;  ///< "file:line"

private:
    const TraceGraph& trace() const { return opened.annotator->document().trace; }
    glm::dvec3 in_volume(const glm::dvec3& voxel) const { return voxel * opened.source->info().spacing; }
    double in_volume(double radius_voxels) const { return radius_voxels * opened.source->info().spacing.x; }

    /// What `act` returns; what it cannot do is said with the line.
    template <class Act>
    auto in_words(const Act& act) const
    {
        try {
            return act();
        } catch (const Error& error) {
            fail(at, ": ", error.what());
        }
    }
    template <class Make>
    void edit(std::string label, const Make& make)
    {
        opened.annotator->edit_trace(std::move(label), in_words(make));
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
    void operator()(const NodeOp& op)
    {
        const ProbeSettings& probe = opened.session.probe;
        const TraceNode node{in_volume(op.at), in_volume(op.radius_voxels.value_or(probe.radius_voxels)),
                             op.group.value_or(probe.group)};
        edit(sentence("node, group ", int(node.group)), [&] { return add_node(trace(), node); });
        say(options.common, sentence(at, ": node ", *trace().selection().node(), " in group ", int(node.group)));
    }
    void operator()(const SelectOp& op)
    {
        const TraceGraph& graph = trace();
        const char* what = op.is_internode ? "internode" : "node";
        if (op.number &&
            !(op.is_internode ? graph.internodes().contains(*op.number) : graph.nodes().contains(*op.number)))
            fail(at, ": there is no ", what, " ", *op.number, "; expected one that the trace has");
        TraceSelection selection;
        if (op.number) (op.is_internode ? selection.internodes : selection.nodes) = {*op.number};
        if (op.near)
            selection = in_words([&] {
                return op.is_internode ? nearest_internode_selection(graph, in_volume(*op.near))
                                       : nearest_node_selection(graph, in_volume(*op.near));
            });
        if (op.within_voxels) {
            const double away = op.is_internode
                                    ? distance_to(graph, graph.internode(selection.internodes[0]), in_volume(*op.near))
                                    : glm::length(graph.node(selection.nodes[0]).position - in_volume(*op.near));
            if (away > in_volume(*op.within_voxels))
                fail(at, ": the nearest ", what, " is ", away / in_volume(1.0), " voxels away; expected one within ",
                     *op.within_voxels);
        }
        opened.annotator->select_trace(std::move(selection));
    }
    void operator()(const SelectSegmentOp&)
    {
        opened.annotator->select_trace(in_words([&] { return segment_selection(trace()); }));
    }
    void operator()(const DeselectOp&) { opened.annotator->select_trace({}); }
    void operator()(const LinkOp& op)
    {
        if (op.node && !trace().nodes().contains(*op.node))
            fail(at, ": there is no node ", *op.node, "; expected one that the trace has");
        edit("link", [&] {
            const std::optional<uint32_t> to =
                op.node ? op.node : trace().nearest_node(in_volume(*op.near), trace().selection().node());
            if (!to) fail("there is no other node; expected one to link with");
            return link_selected(trace(), *to);
        });
    }
    void operator()(const MoveOp& op)
    {
        edit("move", [&] { return move_selected(trace(), in_volume(op.to)); });
    }
    void operator()(const DeleteOp&)
    {
        edit("delete", [&] { return delete_selected(trace()); });
    }
    void operator()(const GroupOp& op)
    {
        edit(sentence("group ", int(op.group)), [&] { return set_group_of_selected(trace(), op.group); });
    }
    void operator()(const RadiusOp& op)
    {
        std::optional<double> radius;
        if (op.radius_voxels) radius = in_volume(*op.radius_voxels);
        edit("size", [&] {
            switch (op.of) {
                case RadiusOp::Of::nodes: return set_node_radii(trace(), op.group, radius.value());
                case RadiusOp::Of::internodes: return set_internode_radius(trace(), op.group, radius);
                case RadiusOp::Of::selected: break;
            }
            return set_radius_of_selected(trace(), radius.value());
        });
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
        for (const std::filesystem::path& path : in_words([&] { return opened.annotator->save(); }))
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

void run(const Options& options)
{
    const std::vector<ScriptLine> script = read_script(options.script);
    Opened opened = open(options.project, options.common, options.fresh ? Work::Start::fresh : Work::Start::as_left);
    const VolumeInfo& volume = opened.source->info();
    for (const ScriptLine& line : script)  // before anything is painted
        if (const auto* paint = std::get_if<PaintOp>(&line.op)) try {
                check_radius(paint->radius_voxels, volume.spacing, volume.size);
            } catch (const Error& error) {
                fail(options.script, ":", line.number, ": ", error.what());
            }
    Replay replay{opened, options};
    for (const ScriptLine& line : script) {
        replay.at = sentence(options.script, ":", line.number);
        std::visit(replay, line.op);
    }
    opened.annotator->flush();
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
    auto options = std::make_shared<Options>();
    CLI::App* command = program.add_subcommand("annotate", "Replays annotation commands");
    command->add_option("PROJECT", options->project, "Project folder or session (.json)")->required();
    command->add_option("--script", options->script, "Commands, one JSON object a line")->required();
    command->add_flag("--fresh", options->fresh,
                      "Start without the annotation there is; its journal is kept as JOURNAL.old");
    add_device_options(*command, options->common);
    add_output_options(*command, options->common);
    command->footer(
        "Example:\n  shvr annotate scan/ --script strokes.jsonl\nwith lines such as\n"
        "  {\"op\":\"paint\",\"brush\":\"flood\",\"region\":\"ball\",\"group\":1,\"threshold\":1200,\"radius\":8,"
        "\"path\":[[40,52,18],[41,53,30]]}\n  {\"op\":\"node\",\"at\":[40,52,18],\"radius\":3,\"group\":2}\n"
        "  {\"op\":\"density\",\"brush\":\"flood\",\"threshold\":900,\"offset\":\"automatic\",\"falloff\":"
        "\"distance\",\"radius\":8,\"path\":[[40,52,18]]}\n  {\"op\":\"undo\",\"count\":1}\n  {\"op\":\"save\"}");
    command->callback([options] { run(*options); });
}

}  // namespace shvr::cli
