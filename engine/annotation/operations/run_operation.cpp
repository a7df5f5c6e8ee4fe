#include "engine/annotation/operations/run_operation.h"

#include "engine/base/text.h"

namespace shvr {

namespace {

void check_box(const OperationLimits& limits, const glm::i64vec3& size)
{
    if (limits.box && (glm::any(glm::greaterThanEqual(limits.box->lower, size)) ||
                       glm::any(glm::lessThanEqual(limits.box->upper, glm::i64vec3(0)))))
        fail("key box is ", text_of(*limits.box), "; expected a box that has voxels of the volume, which has ", size.x,
             " x ", size.y, " x ", size.z);
}

}  // namespace

OperationResult run(const GroupOperation& operation, const OperationInput& input, const Progress& progress)
{
    return std::visit(
        [&](const auto& op) {
            const OperationLimits none;
            const OperationLimits* limits = &none;
            if constexpr (requires { op.limits; }) limits = &op.limits;
            check_box(*limits, glm::i64vec3(input.volume.size));
            MaskEdit edit(input, *limits);
            tell(progress, 0.0);
            perform(op, edit, progress);
            tell(progress, 1.0);
            return edit.take();
        },
        operation);
}

std::string label_of(const GroupOperation& operation)
{
    const std::string title = lower_case(row_of(operation).title);
    return std::visit(
        [&](const auto& op) {
            if constexpr (requires { op.group; })
                return sentence(title, ", group ", op.group);
            else
                return title;
        },
        operation);
}

bool needs_intensities(const GroupOperation& operation)
{
    return std::visit(
        []<class Op>(const Op& op) {
            if constexpr (requires { Op::READS_INTENSITIES; })
                return true;
            else if constexpr (requires { op.limits; })
                return op.limits.within.has_value();
            else
                return false;
        },
        operation);
}

}  // namespace shvr
