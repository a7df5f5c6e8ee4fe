#include "engine/tasks/describe_task.h"

#include "engine/annotation/files/stated_content.h"
#include "engine/remote/address.h"

namespace shvr {

void fields(Fields& f, DescribeTask& task)
{
    f.path("input", task.input,
           {.meaning = "volume, session or project folder, or the address of a volume",
            .allowed = PATH_OR_ADDRESS,
            .standard = "required",
            .is_required = true});
    f.flag("exact", task.exact,
           {"go through all voxels, also of volumes so large that a sample or a coarser level would do"});
    incomplete_field(f, task.allows_incomplete, "voxels that cannot be read are left out of every number");
    texts_field(
        f, "set", task.settings,
        {.meaning = "keys of a session, each as in `\"volume.unit=um\"`", .allowed = "texts", .standard = "none"});
}

DescribeResult run(const DescribeTask& task, ProgressReporter& reporter)
{
    std::error_code ignored;
    const bool is_there =
        std::filesystem::exists(task.input, ignored) || leads_into_archive(task.input) || leads_to_network(task.input);
    const bool is_bare = is_there && session_file_of(task.input).empty();
    OpenedSession opened;
    Gaps gaps = gaps_of(task.allows_incomplete, task.names);
    const OpeningOptions opening{.measure = {.exact = task.exact,
                                             .progress = reporter.begin("measuring " + task.input.string()),
                                             .gaps = &gaps}};
    // Opening a bare volume as a session would compute a transfer function, which is not needed here.
    if (is_bare) {
        if (task.settings.empty()) {
            opened.source = open_volume(task.input);
        } else {
            UnmeasuredSession set = open_unmeasured_session(task.input, task.settings);
            opened.source = std::move(set.source);
            opened.removed = std::move(set.removed);
        }
        opened.statistics = measure(*opened.source, opening.measure);
        opened.warnings = warnings_of(opened.statistics);
        // Opening an address has asked for that already, and warns of it.
        const bool is_remote = leads_to_network(task.input);
        if (std::string archived = is_remote ? "" : archived_project(task.input); !archived.empty())
            opened.losses.push_back(std::move(archived));
    } else {
        opened = open_session(task.input, task.settings, opening);
    }
    DescribeResult result{.info = opened.source->info(),
                          .statistics = opened.statistics,
                          .levels = opened.source->levels(),
                          .voxels_not_read = gaps.voxels(),
                          .mask = opened.session.mask_path,
                          .warnings = std::move(opened.warnings),
                          .losses = std::move(opened.losses)};
    for (std::string& removed : opened.removed) result.warnings.push_back(std::move(removed));
    for (const std::string& warning : result.info.warnings) result.warnings.push_back(warning);
    const std::string labels =
        is_bare && gaps.empty() ? labels_in_words(*opened.source, opened.statistics) : std::string();
    if (!labels.empty() && !stated_content(task.input))
        result.warnings.push_back("looks like a label image, not like a scan: " + labels);
    if (!gaps.empty()) result.warnings.push_back(gaps.in_words() + " and are left out of every number");
    return result;
}

}  // namespace shvr
