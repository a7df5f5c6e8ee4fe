// shvr annotate: replays a script of annotation commands.

#include <algorithm>
#include <concepts>

#include "engine/annotation/script/script.h"
#include "engine/annotation/writers/hold.h"
#include "engine/base/assets.h"
#include "engine/base/text.h"
#include "engine/remote/address.h"
#include "engine/workbench/workbench.h"
#include "tools/cli/cli.h"
#include "tools/cli/rest.h"

namespace shvr::cli {

namespace {

struct AnnotateCommandOptions {
    Common common;
    std::string project, script, actions;
    bool fresh = false;
    bool verbose = false;
};

/// A line of a script: an operation on the annotation, or a file that is loaded into it as by the window.
struct Command {
    int number = 0;  ///< its line, from 1
    std::variant<ScriptOp, ui::LoadAnnotation> what;
};

/// The operation of a line, null for a load.
const ScriptOp* op_of(const Command& command)
{
    return std::get_if<ScriptOp>(&command.what);
}

/// Reads a "load" line as the window's action of that name.
ui::LoadAnnotation read_load(const JsonNode& line)
{
    const ui::LoadAnnotation load = *ui::read_action(line).as<ui::LoadAnnotation>();
    if (load.what == ui::FileUse::scan)
        line["what"].refuse("mask, offsets, trace, look or by_contents: a scan is opened, not loaded");
    std::error_code ignored;
    if (!std::filesystem::exists(load.path, ignored)) line["path"].refuse("a file that exists");
    return load;
}

/// Reads and checks the whole script before anything is run.
std::vector<Command> read_commands(const std::filesystem::path& path)
{
    static constexpr std::string_view LOAD[] = {"load"};
    std::vector<Command> commands;
    for_each_line(path, [&](const JsonNode& line, int number) {
        if (line.is_object() && line["op"].is(LOAD[0]))
            commands.push_back({number, read_load(line)});
        else
            commands.push_back({number, read_script_op(line, LOAD)});
    });
    return commands;
}

/// Drives the workbench by the lines of a script instead of by input to the window.
class Replay {
public:
    Replay(ui::Workbench& workbench, const AnnotateCommandOptions& given, LongWork& long_work)
        : bench(workbench), options(given), work(long_work), steps_before(annotator().history().undoable())
    {}

    ui::Workbench& bench;
    const AnnotateCommandOptions& options;
    LongWork& work;
    double done = 0.0, share = 0.0;  ///< shares of the script: all lines before the present line, and the present line
    int64_t voxels_changed = 0;
    StrokeResult::ByGroup taken_from{};
    int64_t kept_locked = 0, kept_painted = 0;  ///< voxels
    std::string at;                             ///< "file:line"
    size_t steps_before = 0;                    ///< length of the history before the first line

    /// States the steps that earlier lines have done and that are kept; empty if there are none.
    std::string kept_in_words() const
    {
        const size_t now = annotator().history().undoable();
        const size_t steps = now > steps_before ? now - steps_before : 0;
        if (steps == 0) return {};
        return sentence("; ", counted(int64_t(steps), "step"), " of earlier lines ", steps == 1 ? "is" : "are",
                        " kept, and can be undone by {\"op\":\"undo\",\"count\":", steps, "}");
    }

private:
    /// With --verbose, prints a message about the present line.
    template <class... Words>
    void tell(const Words&... words) const
    {
        if (options.verbose) say(options.common, sentence(at, ": ", words...));
    }
    const Annotator& annotator() const { return bench.document().annotator; }
    const TraceGraph& trace() const { return annotator().document().trace; }

    /// Returns the result of `act`. If `act` throws an error, adds the line's number to the message.
    template <class Act>
    auto in_words(const Act& act) const
    {
        try {
            return act();
        } catch (const DeviceLost&) {
            throw;
        } catch (const Error& error) {
            fail(at, ": ", error.what(), kept_in_words());
        }
    }

    /// Warns of groups that the operation reads and that have no voxels.
    template <class Op>
    void warn_of_empty(const Op& op) const
    {
        std::vector<int64_t> groups;
        if constexpr (requires { op.with; })
            groups.push_back(op.with);
        else if constexpr (requires { op.groups; })
            groups.assign(op.groups.begin(), op.groups.end());
        else if constexpr (!requires { Op::PAINTS_ONLY; })
            groups.push_back(op.group);
        const std::array<int64_t, 256> counts = annotator().document().mask.voxels_by_group();
        for (const int64_t group : groups)
            if (counts[size_t(group)] == 0) warn({sentence(at, ": group ", group, " has no voxels")}, options.common);
    }

    /// Performs all of them or none.
    void expect_steps(const char* what, int count, size_t there) const
    {
        if (size_t(count) > there)
            fail(at, ": key count is ", count, "; expected at most ", there, ", the steps there are to ", what,
                 "; none was taken", kept_in_words());
    }

public:
    void operator()(const PaintOp& op)
    {
        in_words([&] { bench.perform(op); });
        const StrokeResult& result = annotator().last_stroke();
        voxels_changed += result.voxels();
        for (const auto& [group, voxels] : result.taken_from) taken_from[group] += voxels;
        kept_locked += result.kept_by_locks();
        kept_painted += result.kept_painted;
        const std::string& said = bench.messages().last();
        if (result.kept_locked_out > 0)
            warn({sentence(at, ": ", said)}, options.common);  // the line does not have its intended effect
        else
            tell(said);
    }
    template <class Op>
    requires IS_GROUP_OPERATION<Op>
    void operator()(const Op& op)
    {
        warn_of_empty(op);
        in_words([&] { bench.perform(op); });
        const OperationResult& result = in_words([&]() -> const OperationResult& {
            return bench.finish_operation([&](double fraction) {
                work.show(done + share * fraction, {}, -1.0);
                if (work.is_asked_to_stop()) throw Stopped("stopped; nothing of this line was done");
            });
        });
        voxels_changed += result.voxels;
        for (const auto& [groups, voxels] : result.moved)
            if (groups.first != 0) taken_from[groups.first] += voxels;
        for (const auto& [group, voxels] : result.kept_locked) kept_locked += voxels;
        const std::string& said = bench.messages().last();
        if (!result.kept_locked.empty())
            warn({sentence(at, ": ", said)}, options.common);  // the line does not have its intended effect
        else
            tell(said);
    }
    template <class Op>
    requires std::constructible_from<TraceOp, Op>
    void operator()(const Op& op)
    {
        in_words([&] { bench.perform(op); });
        if constexpr (std::same_as<Op, NodeOp>) {
            const uint32_t number = trace().selection().node().value();
            tell("node ", number, " in group ", int(trace().node(number).group));
        }
    }
    void operator()(const UndoOp& op)
    {
        expect_steps("undo", op.count, annotator().history().undoable());
        in_words([&] { bench.perform(op); });
    }
    void operator()(const RedoOp& op)
    {
        expect_steps("redo", op.count, annotator().history().redoable());
        in_words([&] { bench.perform(op); });
    }
    void operator()(const SaveOp& op)
    {
        const Work::Saved saved = in_words([&] {
            bench.perform(op);
            return bench.finish_save([&](double fraction) {
                work.show(done + share * fraction, {}, -1.0);
                if (!work.is_asked_to_stop()) return;
                bench.flush();
                throw Stopped(
                    "stopped during this save; no file is left half written, and the journal has all "
                    "commands");
            });
        });
        warn(saved.notices, options.common);
        for (const std::filesystem::path& path : saved.files)
            say(options.common, sentence(at, ": saved ", path.string()));
    }
    void operator()(const RevertOp& op)
    {
        in_words([&] { bench.perform(op); });
        tell(bench.messages().last());
    }
    void operator()(const ui::LoadAnnotation& load)
    {
        const uint64_t told_before = bench.messages().count();
        in_words([&] {
            bench.perform(load);
            for (uint64_t turn = 0; bench.has_work(); ++turn) {
                if (work.is_asked_to_stop()) throw Stopped("stopped; nothing of this line was done");
                rest(turn);
                bench.advance();
            }
            if (const ui::Message* error = bench.messages().first_after(told_before, ui::Weight::error))
                fail(error->text);
        });
        if (const ui::Message* warning = bench.messages().first_after(told_before, ui::Weight::warning))
            warn({sentence(at, ": ", warning->text)}, options.common);
        else
            tell(bench.messages().last());
    }
    void operator()(const ExpectOp& op)
    {
        const Document& document = annotator().document();
        const std::array<int64_t, 256> counts = document.mask.voxels_by_group();
        for (const auto& [group, voxels] : op.voxels_in_group)
            if (counts[group] != voxels)
                throw GateError(
                    sentence(at, ": group ", int(group), " has ", counts[group], " voxels; expected ", voxels));
        const std::tuple<const char*, std::optional<int64_t>, size_t> traced[] = {
            {"nodes", op.nodes, trace().nodes().size()}, {"internodes", op.internodes, trace().internodes().size()}};
        for (const auto& [what, expected, found] : traced)
            if (expected && *expected != int64_t(found))
                throw GateError(sentence(at, ": ", found, " ", what, "; expected ", *expected));
        const int64_t raised = document.density.voxels();
        if (op.voxels_with_offset.value_or(raised) != raised)
            throw GateError(sentence(at, ": ", raised, " voxels have an offset; expected ", *op.voxels_with_offset));
    }
};

/// Checks before anything is painted.
void check_radii(const std::vector<Command>& script, const std::string& name, const VolumeInfo& volume)
{
    for (const Command& line : script)
        if (const auto* paint = op_of(line) ? std::get_if<PaintOp>(op_of(line)) : nullptr) try {
                check_radius(paint->radius_voxels, volume.spacing, volume.size);
            } catch (const Error& error) {
                fail(name, ":", line.number, ": ", error.what());
            }
}

bool is_painting_operation(const ScriptOp& op)
{
    return std::visit(
        []<class Op>(const Op&) {
            if constexpr (requires { Op::ADDS_TRACE; })
                return false;
            else
                return IS_GROUP_OPERATION<Op>;
        },
        op);
}

/// Checks, before anything is done, whether a script that saves has file names to save to.
void check_names(const std::vector<Command>& script, const std::string& name, const std::string& project,
                 const Session& session)
{
    const Command* save = nullptr;
    bool paints = false, raises = false;
    for (const Command& line : script) {
        if (const auto* const load = std::get_if<ui::LoadAnnotation>(&line.what)) {
            paints |= load->what == ui::FileUse::mask;
            raises |= load->what == ui::FileUse::offsets;
            continue;
        }
        const ScriptOp& op = *op_of(line);
        if (!save && std::holds_alternative<SaveOp>(op)) save = &line;
        const auto* const paint = std::get_if<PaintOp>(&op);
        paints |= paint ? paint->paints_group : is_painting_operation(op);
        raises |= paint && paint->density;
    }
    if (!save) return;
    const std::filesystem::path file = session_file_of(project);
    const auto refuse = [&](const char* what, const char* key, const char* extension) {
        const std::string suggested = file.stem().string() + extension;
        fail(file.string(), ": names no file for the ", what, ", which ", name, ":", save->number,
             " saves; expected the key annotation.", key, ", as in \"annotation\": {\"", key, "\": \"", suggested,
             "\"}, or --set annotation.", key, "=", suggested);
    };
    if (session.mask_path.empty() && (session.trace_path.empty() || paints)) refuse("mask", "mask", ".labels.zarr");
    if (session.density_path.empty() && raises) refuse("density offsets", "density", ".offsets.zarr");
}

/// Takes the journal's lock. Null if the project is a volume without a journal, or its folder supports no locks.
std::shared_ptr<Hold> hold_of(const std::string& project, const Common& common)
{
    const std::filesystem::path session = session_file_of(project);
    if (session.empty()) return nullptr;
    Session named;
    named.journal_path = journal_beside(session);
    check_outside(project, named, common);  // its lock lies there, too
    return Hold::take(named.journal_path, "shvr annotate");
}

/// Refuses a volume without a project, since the script's annotation would not be stored anywhere.
[[noreturn]] void refuse_bare_volume(const std::string& project)
{
    const std::filesystem::path given(project);
    const std::filesystem::path volume = leads_to_network(given) ? given.filename() : given.lexically_normal();
    std::filesystem::path suggested = volume.has_filename() ? volume : volume.parent_path();
    suggested = suggested.extension().empty() ? suggested += "-project" : suggested.replace_extension();
    fail(project, ": is a volume, and annotation is kept only in projects; expected one, as made by: shvr import ",
         in_quotes(project), " ", in_quotes(suggested.string()));
}

void run_annotate(const AnnotateCommandOptions& options)
{
    const std::shared_ptr<Hold> hold = hold_of(options.project, options.common);  // refused before any work
    const std::string name = name_of_script(options.script);
    const std::vector<Command> script = read_commands(options.script);
    LongWork work(options.common.quiet);
    Opened opened = open(options.project, options.common, work,
                         {.start = options.fresh ? Work::Start::fresh : Work::Start::as_left,
                          .takes_over = std::ranges::any_of(
                              script, [](const Command& line) { return !op_of(line) || changes_work(*op_of(line)); }),
                          .hold = hold,
                          .program = "shvr annotate"},
                         [&](const Session& session, const VolumeInfo&) {
                             check_outside(options.project, session, options.common);
                             if (!session_file_of(options.project).empty())
                                 check_names(script, name, options.project, session);
                         });
    if (opened.project.empty()) refuse_bare_volume(options.project);
    check_radii(script, name, opened.source->info());
    ui::Workbench bench(*opened.renderer, {.has_servo = false, .is_script = true});
    const std::filesystem::path session = opened.project;
    bench.take({.opened = {.session = opened.session, .source = opened.source, .statistics = opened.statistics},
                .session_path = session,
                .overridden = options.common.settings,
                .work = opened.annotator->take_work(),
                .session_text = ui::text_of_session(session)});
    opened.annotator.reset();
    Replay replay{bench, options, work};
    static_cast<void>(work.begin("replaying " + name));
    for (size_t done = 0; done < script.size(); ++done) {
        replay.at = sentence(name, ":", script[done].number);
        if (work.is_asked_to_stop()) {
            bench.flush();
            fail(replay.at, ": stopped before this line; the ", done, " commands before it are kept");
        }
        replay.share = 1.0 / double(script.size());
        replay.done = double(done) * replay.share;
        work.show(replay.done, {}, -1.0);
        if (const ScriptOp* const op = op_of(script[done]))
            std::visit(replay, *op);
        else
            replay(std::get<ui::LoadAnnotation>(script[done].what));
    }
    bench.flush();
    check_validation(opened);
    const Annotator& annotator = bench.document().annotator;
    const std::string kept = replay.kept_locked > 0 ? sentence(replay.kept_locked, " kept by locks, ") : std::string();
    Json taken_from = Json::object();
    for (const auto& [group, voxels] : replay.taken_from) taken_from[std::to_string(group)] = voxels;
    if (!options.common.json)
        say(options.common, sentence(name, ": ", counted(int64_t(script.size()), "command"), ", ",
                                     counted(int64_t(replay.voxels_changed), "voxel"), " changed, ", kept,
                                     counted(int64_t(annotator.work().unsaved()), "step"), " not saved"));
    else
        print({{"commands", script.size()},
               {"voxels_changed", replay.voxels_changed},
               {"voxels_taken_from", taken_from},
               {"voxels_kept_locked", replay.kept_locked},
               {"voxels_kept_painted", replay.kept_painted},
               {"nodes", annotator.document().trace.nodes().size()},
               {"internodes", annotator.document().trace.internodes().size()},
               {"journal_bytes", annotator.work().journal().bytes}});
}

/// Performs an action and waits until all work started by the action is done. Errors that the window would only display
/// are failures here.
void perform_to_end(ui::Workbench& bench, const ui::Action& action, const LongWork& work)
{
    const uint64_t told_before = bench.messages().count();
    bench.perform(action);
    if (!bench.document().annotator.stroke_is_open()) {
        if (const std::string unpainted = bench.finish_stroke(); !unpainted.empty()) fail(unpainted);
        for (uint64_t turn = 0; bench.has_work(); ++turn) {
            if (work.is_asked_to_stop()) bench.cancel_save();
            rest(turn);
            bench.advance();
        }
    }
    if (const ui::Message* error = bench.messages().first_after(told_before, ui::Weight::error)) fail(error->text);
}

/// Replays, without a display, a user's actions in the window as logged by `shvr view --log`.
void run_actions(const AnnotateCommandOptions& options)
{
    const std::string name = name_of_script(options.actions);
    std::vector<std::pair<int, ui::Action>> actions;
    for_each_line(options.actions,
                  [&](const JsonNode& line, int number) { actions.emplace_back(number, ui::read_action(line)); });
    LongWork work(options.common.quiet);
    const char* validation = std::getenv("SHVR_VALIDATION");
    Renderer renderer({.device = {options.common.device, validation && *validation == '1'},
                       .budget = {options.common.budget_device_mib << 20, options.common.budget_host_mib << 20},
                       .threads = options.common.threads});
    ui::Workbench bench(renderer, {.has_servo = false,
                                   .saves_outside = options.common.outside,
                                   .settings = config_folder(),
                                   .has_preferences = false,  // a replay must not depend on the user's preferences
                                   .slices_follow = false});
    static_cast<void>(work.begin("opening " + options.project));
    bench.open(options.project, options.common.settings);
    if (bench.document().only_looks())
        throw JournalTaken(sentence(
            options.project, ": cannot be annotated: ", bench.document().why_only_looks(),
            bench.document().outside.empty() ? "; expected it to be closed there first" : "; --outside writes there"));
    static_cast<void>(work.begin("replaying " + name));
    bench.set_hand_down(true);  // setting changes stay in one history step until the log ends it
    size_t done = 0;
    for (const auto& [number, action] : actions) {
        work.show(double(done++) / double(actions.size()), {}, -1.0);
        try {
            perform_to_end(bench, action, work);
        } catch (const Error& error) {
            fail(name, ":", number, ": ", error.what());
        }
        work.stop_if_asked();
    }
    const std::string unpainted = bench.finish_stroke();
    if (!unpainted.empty()) fail(name, ": the last stroke was not painted: ", unpainted);
    bench.perform(ui::EndStep{});
    const ui::Document& document = bench.document();
    const std::vector<std::string> messages = renderer.device().take_validation_messages();
    if (!messages.empty()) fail(messages.size(), " validation messages, the first: ", messages.front());
    const Mask& mask = document.annotator.document().mask;
    Json groups = Json::object();
    for (size_t group = 1; group < 256; ++group)
        if (mask.voxels_by_group()[group] > 0) groups[std::to_string(group)] = mask.voxels_by_group()[group];
    if (!options.common.json)
        return say(options.common, sentence(name, ": ", actions.size(), " actions; ", bench.messages().last()));
    print({{"actions", actions.size()},
           {"voxels_in_group", groups},
           {"nodes", document.annotator.document().trace.nodes().size()},
           {"internodes", document.annotator.document().trace.internodes().size()},
           {"undoable", document.annotator.history().undoable()},
           {"journal_bytes", document.annotator.work().journal().bytes}});
}

}  // namespace

void add_annotate(CLI::App& program)
{
    auto options = std::make_shared<AnnotateCommandOptions>();
    CLI::App* command = program.add_subcommand("annotate", "Runs annotation commands from a script");
    command->add_option("PROJECT", options->project, "Project folder or session (.json)")->required();
    CLI::Option* const script =
        command->add_option("--script", options->script, "Commands, one JSON object a line; - is standard input");
    command->add_option("--actions", options->actions, "What was done in the window, as shvr view --log writes it")
        ->excludes(script);
    command->add_flag("--fresh", options->fresh,
                      "Start without the existing annotation; its journal is kept as JOURNAL.old");
    command->add_flag("--verbose", options->verbose, "A line for each command that paints or adds a node");
    add_belief_option(*command, options->common);
    add_outside_option(*command, options->common);
    add_device_options(*command, options->common);
    add_output_options(*command, options->common);
    command->footer(
        "Example:\n  shvr annotate scan/ --script strokes.jsonl\nwith lines such as\n"
        "  {\"op\":\"paint\",\"brush\":\"flood\",\"region\":\"ball\",\"group\":1,\"threshold\":1200,\"radius\":8,"
        "\"path\":[[40,52,18],[41,53,30]]}\n  {\"op\":\"node\",\"at\":[40,52,18],\"radius\":3,\"group\":2}\n"
        "  {\"op\":\"density\",\"brush\":\"flood\",\"threshold\":900,\"offset\":\"automatic\",\"falloff\":"
        "\"distance\",\"radius\":8,\"path\":[[40,52,18]]}\n  {\"op\":\"undo\",\"count\":1}\n  {\"op\":\"save\"}");
    command->callback([options] {
        if (options->script.empty() && options->actions.empty())
            throw UsageError("neither --script nor --actions is given; expected one of them");
        if (options->script.empty())
            run_actions(*options);
        else
            run_annotate(*options);
    });
}

}  // namespace shvr::cli
