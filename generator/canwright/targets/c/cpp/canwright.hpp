/**
 * @file
 * What the C++ headers of all editions share: raw integers, results, and the access to fields by tags. There are no
 * exceptions, no run-time type information and no heap. Mistakes in a call are reported as one sentence.
 */
#ifndef CANWRIGHT_HPP
#define CANWRIGHT_HPP

#if !defined(__cplusplus) || __cplusplus < 201703L
#error "canwright.hpp needs C++17."
#endif

#if !__has_include(<type_traits>)
#error "canwright.hpp needs <type_traits> and <utility>, which avr-gcc lacks; include the headers for C, which end in .h."
#endif

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "canwright.h"

namespace canwright {

using frame = ::canwright_frame_t;
using status = ::canwright_status_t;

/** A raw integer, as it is on the wire. A number in floating point does not compile: `set` converts values. */
template <class Integer> class raw {
public:
    constexpr raw() noexcept = default;
    constexpr raw(Integer number) noexcept : number_(number) {}
    template <class Number, ::std::enable_if_t<::std::is_floating_point_v<Number>, int> = 0> raw(Number) = delete;
    constexpr operator Integer() const noexcept
    {
        return number_;
    }

private:
    Integer number_ = 0;
};

/** A value, or the reason why there is none and the field that is rejected, if one is. */
template <class Value, class Field> class result {
public:
    constexpr explicit result(const Value &value) noexcept : value_(value) {}
    constexpr explicit result(status why, Field field = Field()) noexcept : why_(why), field_(field) {}
    constexpr explicit operator bool() const noexcept
    {
        return why_ == CANWRIGHT_OK;
    }
    constexpr bool has_value() const noexcept
    {
        return why_ == CANWRIGHT_OK;
    }
    /** The value; a default value if there is none. */
    constexpr const Value &operator*() const noexcept
    {
        return value_;
    }
    constexpr const Value *operator->() const noexcept
    {
        return &value_;
    }
    constexpr Value value_or(Value other) const noexcept
    {
        return has_value() ? value_ : other;
    }
    /** CANWRIGHT_OK, or the reason. */
    constexpr status why() const noexcept
    {
        return why_;
    }
    /** The rejected field; its number is 0 without one. */
    constexpr Field field() const noexcept
    {
        return field_;
    }

private:
    Value value_{};
    status why_ = CANWRIGHT_OK;
    Field field_{};
};

/** A field of messages: an enumerator of an edition as a type. */
template <auto Field> struct tag {};

/** The base of all messages. */
struct message {};

/** In place of a conversion or of an enumeration that a type does not have. */
struct none {};

/** A field that all nodes have. */
struct always {
    static constexpr bool needs_parameters = false;
    template <class Parameters> static constexpr status check(const Parameters *) noexcept
    {
        return CANWRIGHT_OK;
    }
};

/** A field in a layout: its type, its member, the length of an array or 0, and the nodes that have it. */
template <class Type, auto Member, ::std::size_t Length, class Presence> struct access {
    using type = Type;
    using presence = Presence;
    static constexpr ::std::size_t length = Length;
    static constexpr bool is_array = Length != 0u;
    template <class Message> static constexpr auto &at(Message &message, ::std::size_t index) noexcept
    {
        if constexpr (is_array) {
            return (message.*Member)[index];
        } else {
            static_cast<void>(index);
            return message.*Member;
        }
    }
};

namespace detail {

template <class Message, class Tag, class = void> struct has_field : ::std::false_type {};
template <class Message, class Tag>
struct has_field<Message, Tag,
    ::std::void_t<decltype(canwright_access(::std::declval<const Message &>(), Tag{}))>> : ::std::true_type {};

template <class Message, class Tag>
using access_to = decltype(canwright_access(::std::declval<const Message &>(), Tag{}));

/** The conversions of a type: to the unit or to an enumeration, to the unit in single precision, to thousandths. */
struct in_unit {
    template <class Type> using of = typename Type::value;
};
struct in_single {
    template <class Type> using of = typename Type::single;
};
struct in_thousandths {
    template <class Type> using of = typename Type::milli;
};

/** Whether a conversion takes a value: an enumerator, a number, or an integer where the number is one. */
template <class Number, class Value>
constexpr bool takes = ::std::is_same_v<Number, Value>
    || (::std::is_floating_point_v<Number> && ::std::is_arithmetic_v<Value> && !::std::is_same_v<Value, bool>)
    || (::std::is_integral_v<Number> && ::std::is_integral_v<Value> && !::std::is_same_v<Value, bool>);

/** In place of a value where a mistake was reported: without it, each use of the value would be reported too. */
struct mistake {
    template <class Any> constexpr operator Any() const noexcept
    {
        return Any();
    }
};

/** The parameters of the node, if they are given last. */
template <class Parameters> constexpr const Parameters *known() noexcept
{
    return nullptr;
}

template <class Parameters> constexpr const Parameters *known(const Parameters &given) noexcept
{
    return &given;
}

/** Whether the parameters are given where they are needed; each use of `Where` without them is reported. */
template <class Where, class Parameters, bool IsNeeded, class... Rest> constexpr bool check_known() noexcept
{
    constexpr bool fits = sizeof...(Rest) <= 1u && (::std::is_base_of_v<Parameters, Rest> && ...);
    constexpr bool is_given = !IsNeeded || sizeof...(Rest) != 0u;
    static_assert(fits, "only the parameters of the node, of this edition, can follow");
    static_assert(!fits || is_given, "this depends on the parameters of the node; pass them last");
    return fits && is_given;
}

/** Calls `use(index, rest...)` with the index of an element, which is the first argument for an array, else 0. */
template <class Access, class Use> constexpr auto with_index(const Use &use) noexcept
{
    static_assert(!Access::is_array, "an element of an array has its index after the field");
    if constexpr (!Access::is_array) {
        return use(::std::size_t{0u});
    } else {
        return mistake{};
    }
}

template <class Access, class Use, class First, class... Rest>
constexpr auto with_index(const Use &use, const First &first, const Rest &...rest) noexcept
{
    if constexpr (Access::is_array) {
        static_assert(::std::is_integral_v<First>, "an element of an array has its index after the field");
        if constexpr (::std::is_integral_v<First>) {
            return use(static_cast<::std::size_t>(first), rest...);
        } else {
            return mistake{};
        }
    } else {
        return use(::std::size_t{0u}, first, rest...);
    }
}

/** Whether a node has an element of a field: CANWRIGHT_OK, or the reason. */
template <class Access, class Parameters>
constexpr status check(::std::size_t index, const Parameters *parameters) noexcept
{
    if constexpr (Access::is_array) {
        if (index >= Access::length) {
            return CANWRIGHT_OUT_OF_RANGE;
        }
    }
    return Access::presence::check(parameters);
}

template <class Kind, class Message, auto Field, class... Rest>
constexpr auto read(const Message &from, tag<Field>, const Rest &...arguments) noexcept
{
    constexpr bool exists = has_field<Message, tag<Field>>::value;
    static_assert(exists, "the message has no such field");
    if constexpr (exists) {
        using access = access_to<Message, tag<Field>>;
        using parameters = typename access::type::parameters;
        using conversion = typename Kind::template of<typename access::type>;
        constexpr bool converts = !::std::is_same_v<conversion, none>;
        static_assert(converts, "the field has no such value: read its raw integer, or its flags with `has`");
        if constexpr (converts) {
            return with_index<access>(
                [&from](::std::size_t index, const auto &...rest) {
                    using number = typename conversion::number;
                    constexpr bool is_known = check_known<access, parameters,
                        conversion::to_needs_parameters || access::presence::needs_parameters,
                        ::std::decay_t<decltype(rest)>...>();
                    if constexpr (!is_known) {
                        return mistake{};
                    } else if constexpr (conversion::to_fails || access::is_array || access::presence::needs_parameters) {
                        number value{};
                        const parameters *node = known<parameters>(rest...);
                        status why = check<access>(index, node);
                        if (why == CANWRIGHT_OK) {
                            if constexpr (conversion::to_fails) {
                                why = conversion::to(value, access::at(from, index), node);
                            } else {
                                value = conversion::to(access::at(from, index), node);
                            }
                        }
                        return why == CANWRIGHT_OK ? result<number, decltype(Field)>(value)
                                                   : result<number, decltype(Field)>(why, Field);
                    } else {
                        return conversion::to(access::at(from, index), known<parameters>(rest...));
                    }
                },
                arguments...);
        } else {
            return mistake{};
        }
    } else {
        return mistake{};
    }
}

template <class Access, class Conversion, class Message, class Value, class... Rest>
constexpr auto write_value(Message &to, ::std::size_t index, const Value &value, const Rest &...rest) noexcept
{
    using parameters = typename Access::type::parameters;
    using number = typename Conversion::number;
    constexpr bool fits = takes<number, Value>;
    static_assert(fits, "the field takes a value of another type");
    if constexpr (fits) {
        constexpr bool is_known = check_known<Conversion, parameters, Conversion::from_needs_parameters, Rest...>();
        if constexpr (is_known) {
            typename Access::type::integer found{};
            status why = CANWRIGHT_OK;
            if constexpr (Access::is_array) {
                why = index < Access::length ? CANWRIGHT_OK : CANWRIGHT_OUT_OF_RANGE;
            }
            if (why == CANWRIGHT_OK) {
                if constexpr (Conversion::from_fails) {
                    why = Conversion::from(found, static_cast<number>(value), known<parameters>(rest...));
                } else {
                    found = Conversion::from(static_cast<number>(value), known<parameters>(rest...));
                }
            }
            if (why == CANWRIGHT_OK) {
                Access::at(to, index) = found;
            }
            if constexpr (Conversion::from_fails || Access::is_array) {
                return why;
            }
        } else {
            return mistake{};
        }
    } else {
        return mistake{};
    }
}

template <class Access, class Message, class Flag>
constexpr auto write_flag(Message &to, ::std::size_t index, const Flag &flag, bool on = true) noexcept
{
    constexpr bool fits = ::std::is_same_v<Flag, typename Access::type::flags>;
    static_assert(fits, "the field takes flags of another type");
    if constexpr (fits) {
        using integer = typename Access::type::integer;
        if constexpr (Access::is_array) {
            if (index >= Access::length) {
                return CANWRIGHT_OUT_OF_RANGE;
            }
        }
        const integer bits = static_cast<integer>(flag);
        const integer before = Access::at(to, index);
        Access::at(to, index) = static_cast<integer>(on ? before | bits : before & static_cast<integer>(~bits));
        if constexpr (Access::is_array) {
            return CANWRIGHT_OK;
        }
    } else {
        return mistake{};
    }
}

template <class Kind, class Message, auto Field, class... Rest>
constexpr auto write(Message &to, tag<Field>, const Rest &...arguments) noexcept
{
    constexpr bool exists = has_field<Message, tag<Field>>::value;
    static_assert(exists, "the message has no such field");
    if constexpr (exists) {
        using access = access_to<Message, tag<Field>>;
        using conversion = typename Kind::template of<typename access::type>;
        constexpr bool has_flags = !::std::is_same_v<typename access::type::flags, none>;
        constexpr bool converts = has_flags || !::std::is_same_v<conversion, none>;
        static_assert(converts, "the field has no such value: assign its raw integer");
        if constexpr (converts) {
            return with_index<access>(
                [&to](::std::size_t index, const auto &...rest) {
                    if constexpr (has_flags) {
                        return write_flag<access>(to, index, rest...);
                    } else {
                        return write_value<access, conversion>(to, index, rest...);
                    }
                },
                arguments...);
        } else {
            return mistake{};
        }
    } else {
        return mistake{};
    }
}

} /* namespace detail */

/**
 * The value of a field in its unit, or its enumerator: `get(message, field::NAME, index, parameters)`, where an array
 * needs the index, and what depends on parameters needs these. A value that can be absent is a `result`. Where a double
 * does not have 64 bits, `get` and `set` work in single precision.
 */
template <class Message, auto Field, class... Rest>
CANWRIGHT_CHECKED constexpr auto get(const Message &from, tag<Field> field, const Rest &...rest) noexcept
{
    return detail::read<detail::in_unit>(from, field, rest...);
}

/** The same in single precision. */
template <class Message, auto Field, class... Rest>
CANWRIGHT_CHECKED constexpr auto get_float(const Message &from, tag<Field> field, const Rest &...rest) noexcept
{
    return detail::read<detail::in_single>(from, field, rest...);
}

/** The same in thousandths of the unit, in integers. */
template <class Message, auto Field, class... Rest>
CANWRIGHT_CHECKED constexpr auto get_milli(const Message &from, tag<Field> field, const Rest &...rest) noexcept
{
    return detail::read<detail::in_thousandths>(from, field, rest...);
}

/**
 * Sets the raw integer nearest to a value in the unit, the one of an enumerator, or a flag: `set(message, field::NAME,
 * index, value, parameters)`, `set(message, field::NAME, index, flag, on)`. If that can fail, the result is a status.
 */
template <class Message, auto Field, class... Rest>
CANWRIGHT_CHECKED constexpr auto set(Message &to, tag<Field> field, const Rest &...rest) noexcept
{
    return detail::write<detail::in_unit>(to, field, rest...);
}

/** The same in single precision. */
template <class Message, auto Field, class... Rest>
CANWRIGHT_CHECKED constexpr auto set_float(Message &to, tag<Field> field, const Rest &...rest) noexcept
{
    return detail::write<detail::in_single>(to, field, rest...);
}

/** The same in thousandths of the unit, in integers. */
template <class Message, auto Field, class... Rest>
CANWRIGHT_CHECKED constexpr auto set_milli(Message &to, tag<Field> field, const Rest &...rest) noexcept
{
    return detail::write<detail::in_thousandths>(to, field, rest...);
}

/**
 * True if a flag is set: `has(message, field::NAME, index, flag)`, where an array needs the index. It is false for an element
 * that an array does not have, and for a field that the node does not have, as decoding sets it to 0.
 */
template <class Message, auto Field, class... Rest>
CANWRIGHT_CHECKED constexpr bool has(const Message &from, tag<Field>, const Rest &...arguments) noexcept
{
    constexpr bool exists = detail::has_field<Message, tag<Field>>::value;
    static_assert(exists, "the message has no such field");
    if constexpr (exists) {
        using access = detail::access_to<Message, tag<Field>>;
        return detail::with_index<access>(
            [&from](::std::size_t index, const auto &flag) {
                constexpr bool fits = ::std::is_same_v<::std::decay_t<decltype(flag)>, typename access::type::flags>;
                static_assert(fits, "the field has flags of another type");
                if constexpr (fits) {
                    using integer = typename access::type::integer;
                    if constexpr (access::is_array) {
                        if (index >= access::length) {
                            return false;
                        }
                    }
                    const integer raw = access::at(from, index);
                    return (raw & static_cast<integer>(flag)) != 0;
                } else {
                    return false;
                }
            },
            arguments...);
    } else {
        return false;
    }
}

/** Encodes a message to or from a node, if it is valid: `encode(node, message, parameters)`. */
template <class Message, class... Rest>
CANWRIGHT_CHECKED constexpr auto encode(::std::uint32_t node, const Message &message, const Rest &...rest) noexcept
{
    using rules = typename Message::rules;
    static_assert(rules::has_node, "the id of the message has no node; pass the message only");
    using done = result<typename rules::frame, typename rules::field>;
    typename rules::frame to{};
    typename rules::field rejected{};
    status why = CANWRIGHT_UNKNOWN_NODE;
    if constexpr (detail::check_known<rules, typename rules::parameters, rules::encode_needs_parameters, Rest...>()) {
        why = rules::encode(to, node, message, rejected, detail::known<typename rules::parameters>(rest...));
    }
    return why == CANWRIGHT_OK ? done(to) : done(why, rejected);
}

/** Encodes a message whose id has no node. */
template <class Message, class... Rest, ::std::enable_if_t<::std::is_base_of_v<message, Message>, int> = 0>
CANWRIGHT_CHECKED constexpr auto encode(const Message &message, const Rest &...rest) noexcept
{
    using rules = typename Message::rules;
    static_assert(!rules::has_node, "the message is for a node; pass its number first");
    using done = result<typename rules::frame, typename rules::field>;
    typename rules::frame to{};
    typename rules::field rejected{};
    status why = CANWRIGHT_UNKNOWN_NODE;
    if constexpr (detail::check_known<rules, typename rules::parameters, rules::encode_needs_parameters, Rest...>()) {
        why = rules::encode(to, 0u, message, rejected, detail::known<typename rules::parameters>(rest...));
    }
    return why == CANWRIGHT_OK ? done(to) : done(why, rejected);
}

/** Decodes the frame of one message: `decode(message, frame, parameters)`. The result is the node; 0 without one. */
template <class Message, class... Rest>
CANWRIGHT_CHECKED constexpr auto decode(
    Message &message, const typename Message::rules::frame &from, const Rest &...rest) noexcept
{
    using rules = typename Message::rules;
    using done = result<::std::uint32_t, typename rules::field>;
    ::std::uint32_t node = 0u;
    status why = CANWRIGHT_UNKNOWN_ID;
    if constexpr (detail::check_known<rules, typename rules::parameters, rules::decode_needs_parameters, Rest...>()) {
        why = rules::decode(message, node, from, detail::known<typename rules::parameters>(rest...));
    }
    return why == CANWRIGHT_OK ? done(node) : done(why);
}

/** True for two messages of one type with the same raw integers. */
template <class Message, ::std::enable_if_t<::std::is_base_of_v<message, Message>, int> = 0>
constexpr bool operator==(const Message &one, const Message &other) noexcept
{
    return Message::rules::same(one, other);
}

/** True for two messages of one type with different raw integers. */
template <class Message, ::std::enable_if_t<::std::is_base_of_v<message, Message>, int> = 0>
constexpr bool operator!=(const Message &one, const Message &other) noexcept
{
    return !Message::rules::same(one, other);
}

} /* namespace canwright */

#endif
