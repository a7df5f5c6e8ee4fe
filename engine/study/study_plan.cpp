#include <algorithm>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/text.h"
#include "engine/study/study.h"

namespace shvr {

namespace {

constexpr double PROBE_RADII[] = {1.0, 1.5, 2.5};
constexpr double NOISES[] = {3.0, 10.0, 20.0};
constexpr ProxyLaw LAWS[] = {ProxyLaw::potential, ProxyLaw::mean, ProxyLaw::thesis};
constexpr StudyTouch TOUCHES[] = {StudyTouch::surface, StudyTouch::proximity, StudyTouch::object};
constexpr StudyTask TASKS[] = {StudyTask::trace, StudyTask::paint};
constexpr std::string_view CONDITION_KEYS = "task,touch,law,probe_radii,noise";

/// Annotators take the seeds in turn.
uint32_t annotator_of(uint32_t seed)
{
    return 1 + (seed - 1) % STUDY_ANNOTATORS;
}

void add(StudyPlan& plan, const StudyCondition& condition, uint32_t seeds, size_t trait = SIZE_MAX, double factor = 1.0)
{
    for (uint32_t seed = 1; seed <= seeds; ++seed) {
        if (plan.annotators.empty()) plan.items.push_back({condition, annotator_of(seed), seed, trait, factor});
        for (const uint32_t annotator : plan.annotators)
            plan.items.push_back({condition, annotator, seed, trait, factor});
    }
}

StudyCondition without_touch(StudyCondition condition)
{
    condition.touch = StudyTouch::none;
    condition.law = ProxyLaw::potential;
    return condition;
}

/// Returns the conditions that differ from `centre` by one factor, and their counterparts without touch.
std::vector<StudyCondition> conditions_around(const StudyCondition& centre)
{
    std::vector<StudyCondition> conditions;
    const auto with = [&](auto StudyCondition::*factor, auto value) {
        StudyCondition changed = centre;
        changed.*factor = value;
        return changed;
    };
    for (const StudyTouch touch : {StudyTouch::surface, StudyTouch::proximity})
        conditions.push_back(with(&StudyCondition::touch, touch));
    for (const ProxyLaw law : {ProxyLaw::mean, ProxyLaw::thesis}) conditions.push_back(with(&StudyCondition::law, law));
    for (const auto& [factor, values] : {std::pair(&StudyCondition::probe_radii, std::span(PROBE_RADII)),
                                         std::pair(&StudyCondition::noise, std::span(NOISES))})
        for (const double value : values) {
            const StudyCondition changed = with(factor, value);
            if (changed == centre) continue;
            conditions.push_back(without_touch(changed));
            conditions.push_back(changed);
        }
    return conditions;
}

void add_around_centre(StudyPlan& plan, StudyTask task, uint32_t seeds_at_centre, uint32_t seeds_elsewhere)
{
    const StudyCondition centre = study_centre(task);
    add(plan, without_touch(centre), seeds_at_centre);
    add(plan, centre, seeds_at_centre);
    for (const StudyCondition& condition : conditions_around(centre)) add(plan, condition, seeds_elsewhere);
}

void add_variations(StudyPlan& plan, StudyTask task, uint32_t seeds)
{
    for (size_t trait = 0; trait < hand_traits().size(); ++trait)
        for (const double factor : {0.5, 2.0})
            for (const StudyCondition& condition : {without_touch(study_centre(task)), study_centre(task)})
                add(plan, condition, seeds, trait, factor);
}

void add_pairs(StudyPlan& plan, StudyTask task, uint32_t seeds)
{
    for (const StudyCondition& condition : {without_touch(study_centre(task)), study_centre(task)})
        for (uint32_t seed = 1; seed <= seeds; ++seed)
            for (const uint32_t other : {annotator_of(seed), annotator_of(seed + 1)})
                plan.pairs.push_back({condition, annotator_of(seed), other, seed});
}

void add_product(StudyPlan& plan, StudyTask task, uint32_t seeds)
{
    for (const double radii : PROBE_RADII)
        for (const double noise : NOISES) {
            const StudyCondition condition{.task = task, .probe_radii = radii, .noise = noise};
            add(plan, without_touch(condition), seeds);
            for (const StudyTouch touch : TOUCHES)
                for (const ProxyLaw law : LAWS) add(plan, {task, touch, law, radii, noise}, seeds);
        }
}

template <class Value>
Value spelled_value(std::string_view text, const std::string& place)
{
    std::string expected;
    for (const Spelling<Value>& each : spellings_of(Value{})) {
        if (each.name == text) return each.value;
        expected.append(expected.empty() ? "" : ", ").append(each.name);
    }
    fail(place, " is ", in_quotes(text), "; expected one of ", expected);
}

double number_within(std::string_view text, const std::string& place, double least, double most)
{
    const std::optional<double> number = number_of(text);
    if (!number || !(*number >= least && *number <= most))
        fail(place, " is ", in_quotes(text), "; expected a number from ", least, " to ", most);
    return *number;
}

}  // namespace

StudyCondition study_centre(StudyTask task)
{
    return {.task = task, .touch = StudyTouch::object, .law = ProxyLaw::potential, .probe_radii = 1.5, .noise = 10.0};
}

StudyPlan plan_study(const StudyChoice& choice)
{
    const bool is_small = choice.size == StudySize::small;
    StudyPlan plan{.side = is_small ? 96 : 256, .annotators = choice.annotators, .items = {}, .pairs = {}};
    std::ranges::sort(plan.annotators);
    plan.annotators.erase(std::ranges::unique(plan.annotators).begin(), plan.annotators.end());
    for (const StudyCondition& condition : choice.conditions)
        add(plan, condition, choice.seeds.value_or(is_small ? 2 : 10));
    if (!choice.conditions.empty()) return plan;
    for (const StudyTask task : TASKS) {
        if (choice.size == StudySize::full) {
            add_product(plan, task, choice.seeds.value_or(30));
        } else if (is_small) {
            add_around_centre(plan, task, choice.seeds.value_or(3), choice.seeds.value_or(1));
            add_pairs(plan, task, 1);
        } else {
            add_around_centre(plan, task, choice.seeds.value_or(30), choice.seeds.value_or(10));
            add_variations(plan, task, choice.seeds.value_or(10));
            add_pairs(plan, task, choice.seeds.value_or(10));
        }
    }
    return plan;
}

std::vector<StudyCondition> read_study_conditions(const std::filesystem::path& file)
{
    const std::string text = read_text(file, int64_t{1} << 20);
    std::string_view rest = text;
    const std::string_view keys = take_line(rest);
    if (keys != CONDITION_KEYS)
        fail(file.string(), ": line 1 is ", in_quotes(keys), "; expected ", in_quotes(CONDITION_KEYS));
    std::vector<StudyCondition> conditions;
    for (size_t number = 2; !rest.empty(); ++number) {
        std::string_view line = take_line(rest);
        std::vector<std::string_view> fields;
        for (size_t comma = 0; comma != line.npos; line = comma == line.npos ? line : line.substr(comma + 1)) {
            comma = line.find(',');
            fields.push_back(line.substr(0, comma));
        }
        const std::string place = sentence(file.string(), ": line ", number);
        if (fields.size() != 5) fail(place, " has ", fields.size(), " fields; expected 5: ", CONDITION_KEYS);
        conditions.push_back({.task = spelled_value<StudyTask>(fields[0], place + ", column task"),
                              .touch = spelled_value<StudyTouch>(fields[1], place + ", column touch"),
                              .law = spelled_value<ProxyLaw>(fields[2], place + ", column law"),
                              .probe_radii = number_within(fields[3], place + ", column probe_radii", 0.5, 4.0),
                              .noise = number_within(fields[4], place + ", column noise", 0.0, 100.0)});
    }
    if (conditions.empty()) fail(file.string(), ": holds no condition; expected a line for each");
    return conditions;
}

}  // namespace shvr
