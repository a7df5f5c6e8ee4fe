#include "engine/annotation/operations/run_operation.h"

#include "engine/base/text.h"

namespace shvr {

OperationResult run(const GroupOperation& operation, const OperationInput& input, const Progress& progress)
{
    return std::visit(
        [&](const auto& op) {
            const OperationLimits none;
            const OperationLimits* limits = &none;
            if constexpr (requires { op.limits; }) limits = &op.limits;
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
