// What an action that must be refused says.
#pragma once

#include "dapple/base/error.h"

#include <string>

namespace dapple {

// The message of the UserError that the action throws; empty if it throws none.
template <class Action>
std::string error_of(const Action& action)
{
    try {
        action();
    } catch (const UserError& error) {
        return error.what();
    }
    return "";
}

}  // namespace dapple
