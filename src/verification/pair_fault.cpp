#include "verification/pair_fault.hpp"

#include "octopair/error.hpp"

namespace octopair {

void throw_verification_failed(const std::string& words) {
    throw Error(ErrorCode::engine_failed, "verification failed: " + words);
}

std::string name_of_pair(const Pair& pair) {
    return "pair (" + std::to_string(pair.a) + ", " + std::to_string(pair.b) + ")";
}

bool has_position(const RowSearch& rows, const Pair& pair) {
    return pair.a < rows.rows() && pair.b < rows.columns() && (rows.is_join() || pair.a < pair.b);
}

std::string fault_of_position(const RowSearch& rows, const Pair& pair) {
    if (pair.a >= rows.rows()) {
        return name_of_pair(pair) + ": a is not below " + std::to_string(rows.rows()) + ", the number of objects";
    }
    if (pair.b >= rows.columns()) {
        return name_of_pair(pair) + ": b is not below " + std::to_string(rows.columns()) + ", the number of objects";
    }
    return name_of_pair(pair) + ": a is not below b";
}

}  // namespace octopair
