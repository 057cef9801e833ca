-- Identifies frames and decodes their fields, from the tables of an edition. It runs in Lua 5.2 and later, without Wireshark.
--
-- A frame is a table: [0] is the CAN id, the data bytes follow from [1] on; `length`, `extended`, `remote`. For directions, it
-- also has its `number`, the `time` in ns since the start of the capture, and the `mark` "sent" or "received", if there is one.
-- A segment is {index in the frame, 2^low, 2^width, 2^raw_low, whether raw_low counts from bit 32}: some bits of one byte;
-- in the tables it is {byte, low, width, raw_low}, and the byte of the id is -1. Segments that are one whole byte have `byte`,
-- its index in the frame.
-- A key is an unsigned integer as a number, or as a text of its two halves if it has more than 32 bits.

local codec = {}

local TWO_32 = 4294967296

local floor = math.floor

local function power(exponent)
    return floor(2 ^ exponent)
end

-- The segments of a table; those that cross bit 32 of the raw integer are divided there.
local function segments_of(listed)
    local segments = {}
    for _, segment in ipairs(listed) do
        local byte, low, width, raw_low = segment[1], segment[2], segment[3], segment[4]
        local lower = math.min(width, math.max(0, 32 - raw_low))
        if lower > 0 then
            segments[#segments + 1] = { byte + 1, power(low), power(lower), power(raw_low) }
        end
        if width > lower then
            local above = raw_low + lower - 32
            segments[#segments + 1] = { byte + 1, power(low + lower), power(width - lower), power(above), true }
        end
    end
    local first = listed[1]
    if #listed == 1 and first[1] >= 0 and first[2] == 0 and first[3] == 8 and first[4] == 0 then
        segments.byte = first[1] + 1
    end
    return segments
end

-- The bits of the id under a mask, not shifted.
local function id_bits(mask)
    local runs = {}
    for bit = 0, 28 do
        if floor(mask / 2 ^ bit) % 2 == 1 then
            local last = runs[#runs]
            if last and last[2] + last[3] == bit then
                last[3] = last[3] + 1
            else
                runs[#runs + 1] = { -1, bit, 1, bit }
            end
        end
    end
    return segments_of(runs)
end

local function set_of(listed)
    local set = {}
    for _, value in ipairs(listed) do
        set[value] = true
    end
    return set
end

local function link_rule(rule)
    rule.step = rule.step or 1
    rule.first, rule.last = rule.nodes and rule.nodes[1], rule.nodes and rule.nodes[2]
    rule.extended, rule.remote = rule.extended or false, rule.remote or false
    rule.filled = id_bits(rule.mask or 0)
end

-- The names of raw integers by their keys.
local function by_key(members)
    local names = {}
    for _, member in ipairs(members or {}) do
        names[member[1]] = member[2]
    end
    return names
end

local function link_type(type_)
    type_.signed, type_.float = type_.encoding == "signed", type_.encoding == "float"
    type_.half = power((type_.width - 1) % 32)
    type_.plain = type_.linear == nil
    type_.linear = type_.plain and { identity = true } or type_.linear
    type_.scale_by = type_.linear and type_.linear.by
    if type_.scale_by then
        type_.linear = type_.linear.cases
    end
    type_.limited = type_.enum or type_.flags or type_.limits
    if type_.enum then
        type_.enum = by_key(type_.enum)
    end
    type_.names, type_.no_values = by_key(type_.names), type_.no_values or {}
    if type_.flags then
        type_.named = {}
        for number, flag in ipairs(type_.flags) do
            type_.flags[number] = { bit = flag[1], name = flag[2], label = flag[3] }
            type_.named[flag[1]] = true
        end
    end
end

local function link_layout(layout, types)
    layout.values = set_of(layout.values or {})
    layout.constants, layout.parametric, layout.limited, layout.decoded = {}, {}, {}, {}
    for _, field in ipairs(layout.fields) do
        field.type = types[field.type + 1]
        field.only = field.only and set_of(field.only)
        for number, element in ipairs(field.elements) do
            field.elements[number] = segments_of(element)
        end
        if field.parameter then
            layout.parametric[#layout.parametric + 1] = field
        elseif field.constant and field.fixed then
            layout.constants[#layout.constants + 1] = field
        end
        if field.type.limited and not (field.only or field.hidden) then
            layout.limited[#layout.limited + 1] = field
        end
    end
end

-- The exclusive or of two integers of at most 32 bits.
local function xor(left, right)
    local result, bit = 0, 1
    while left > 0 or right > 0 do
        if left % 2 ~= right % 2 then
            result = result + bit
        end
        left, right, bit = math.floor(left / 2), math.floor(right / 2), bit * 2
    end
    return result
end

-- The register of a CRC after each byte, if it was 0 before.
local function crc_table(checksum)
    local register_of, top = {}, math.floor(checksum.size / 2)
    for byte = 0, 255 do
        local register = checksum.reflected and byte or byte * math.floor(checksum.size / 256)
        for _ = 1, 8 do
            local out
            if checksum.reflected then
                out, register = register % 2 == 1, math.floor(register / 2)
            else
                out, register = register >= top, register * 2 % checksum.size
            end
            if out then
                register = xor(register, checksum.poly)
            end
        end
        register_of[byte] = register
    end
    return register_of
end

local function link_checksum(checksum, fields)
    checksum.field, checksum.size = fields[checksum.field + 1], power(checksum.width)
    checksum.poly, checksum.init = checksum.poly or 0, checksum.init or 0
    checksum.divisor, checksum.xor = power(checksum.shift or 0), checksum.xor or 0
    for number, input in ipairs(checksum.inputs) do
        if type(input) == "table" then
            checksum.inputs[number] = segments_of(input)
        end
    end
    if checksum.arithmetic == "crc" then
        checksum.register_of = crc_table(checksum)
    end
end

local function link_message(message, layouts)
    link_rule(message)
    message.layout = layouts[message.layout + 1]
    message.keys = message.keys or {}
    for _, key in ipairs(message.keys) do
        key.segments, key.values = segments_of(key.segments), set_of(key.values)
    end
    message.node = message.node and segments_of(message.node)
    if message.checksum then
        link_checksum(message.checksum, message.layout.fields)
    end
    for _, bits in ipairs(message.reserved) do
        bits[1], bits[2], bits[3] = bits[1] + 1, power(bits[2]), power(bits[3])
    end
end

-- The bits of a node, with the number of nodes that they distinguish.
local function node_bits(listed)
    if not listed then
        return nil
    end
    local width = 0
    for _, segment in ipairs(listed) do
        width = width + segment[3]
    end
    return { segments = segments_of(listed), modulus = power(width) }
end

local function linked_plan(node, messages)
    if type(node) == "number" then
        return messages[node + 1]
    elseif type(node) == "string" then
        return node
    end
    local cases = {}
    for _, case in ipairs(node.cases) do
        local after = linked_plan(case[2], messages)
        for _, value in ipairs(case[1]) do
            cases[value] = after
        end
    end
    local on = node.on
    if type(on) == "table" then
        on = on.mask and id_bits(on.mask) or segments_of(on)
    end
    return { on = on, cases = cases, otherwise = linked_plan(node.otherwise, messages) }
end

-- An edition from its tables: the items themselves in place of their positions, and sets in place of lists.
function codec.edition(tables)
    local messages = tables.messages
    for _, type_ in ipairs(tables.types) do
        link_type(type_)
    end
    for _, layout in ipairs(tables.layouts) do
        link_layout(layout, tables.types)
    end
    for _, message in ipairs(messages) do
        link_message(message, tables.layouts)
        message.answer, message.answers, message.frames = { nodes = {}, echo = false }, {}, 0
    end
    for _, routes in ipairs({ tables.requests, tables.replies }) do
        for _, route in ipairs(routes) do
            link_rule(route)
            route.plan = linked_plan(route.plan, messages)
        end
    end
    for number, position in ipairs(tables.explained) do
        tables.explained[number] = messages[position + 1]
    end
    for _, answer in ipairs(tables.answers) do
        answer.reply, answer.nodes, answer.echo = messages[answer.reply + 1], answer.nodes or {}, answer.echo or false
        answer.asked, answer.reported = node_bits(answer.asked), node_bits(answer.reported)
        answer.frames = answer.frames or 1
        local request = messages[answer.request + 1]
        request.answers[#request.answers + 1], request.answer = answer, request.answers[1] or answer
        request.frames = request.frames + answer.frames
    end
    codec.configure(tables, { {} })
    return tables
end

local function set_offsets(rule, listed)
    rule.offsets = rule.parameter and {} or { 0 }
    for _, parameters in ipairs(listed) do
        local value = rule.parameter and parameters[rule.parameter]
        if value then
            rule.offsets[#rule.offsets + 1] = floor(value.numerator / value.denominator) * (rule.times or 1)
        end
    end
end

-- Sets the parameters in ids: those of all nodes, as a list.
function codec.configure(edition, listed)
    for _, rules in ipairs({ edition.messages, edition.requests, edition.replies }) do
        for _, rule in ipairs(rules) do
            set_offsets(rule, listed)
        end
    end
end

-- The unsigned integer of some segments: the lower 32 bits and the others.
local function read(frame, segments)
    if segments.byte then
        return frame[segments.byte] or 0, 0
    end
    local low, high = 0, 0
    for number = 1, #segments do
        local segment = segments[number]
        local bits = floor((frame[segment[1]] or 0) / segment[2]) % segment[3] * segment[4]
        if segment[5] then
            high = high + bits
        else
            low = low + bits
        end
    end
    return low, high
end

local function key_of(low, high)
    if high == 0 then
        return low
    end
    return string.format("%d:%d", high, low)
end

local function read_key(frame, segments)
    return key_of(read(frame, segments))
end

-- Both halves of the raw integer of a type, and the nearest number, which is exact up to 53 bits.
local function raw_integer(type_, low, high)
    if type_.signed then
        if type_.width <= 32 then
            if low >= type_.half then
                low, high = low + TWO_32 - 2 * type_.half, -1
            end
        elseif high >= type_.half then
            high = high - 2 * type_.half
        end
    end
    return low, high, type_.width <= 53 and high * TWO_32 + low or high * 4294967296.0 + low
end

local function has_bit(low, high, bit)
    if bit < 32 then
        return floor(low / 2 ^ bit) % 2 == 1
    end
    return floor(high / 2 ^ (bit - 32)) % 2 == 1
end

-- Whether a bit of a decoded raw integer is set.
function codec.has_flag(decoded, bit)
    return has_bit(decoded.low, decoded.high, bit)
end

-- The nearest number of the raw integer at some segments.
local function number_at(type_, frame, segments)
    local _, _, number = raw_integer(type_, read(frame, segments))
    return number
end

-- The number of an IEEE 754 bit pattern; nil for infinity and NaN.
local function float_number(width, low, upper)
    local sign_bit, exponent_bits, fraction_bits, high = 2147483648, 8, 23, low
    local fraction = low % 2 ^ 23
    if width == 64 then
        exponent_bits, fraction_bits, high = 11, 52, upper
        fraction = high % 2 ^ 20 * 4294967296.0 + low
    end
    local sign = high >= sign_bit and -1.0 or 1.0
    local biased = floor(high % sign_bit / 2 ^ (31 - exponent_bits))
    local bias = 2 ^ (exponent_bits - 1) - 1
    if biased == 2 * bias + 1 then
        return nil
    end
    if biased == 0 then
        return sign * fraction * 2 ^ (1 - bias) / 2 ^ fraction_bits
    end
    return sign * (1 + fraction / 2 ^ fraction_bits) * 2 ^ (biased - bias)
end

-- A number such as `3.5`, `-2`, `1/3` or `0x1F` as a quotient of integers; nil for another text.
function codec.rational(text)
    local hex = text:match("^%s*0x(%x+)%s*$")
    if hex and #hex <= 8 then
        return { numerator = tonumber(hex, 16) + 0.0, denominator = 1.0 }
    end
    local sign, whole, decimals, divisor = text:match("^%s*(-?)(%d+)%.?(%d*)/?(%d*)%s*$")
    if not whole or (divisor ~= "" and tonumber(divisor) == 0) then
        return nil
    end
    local denominator = (divisor == "" and 1 or tonumber(divisor)) * 10.0 ^ #decimals
    local numerator = tonumber(whole .. decimals) + 0.0
    return { numerator = sign == "-" and -numerator or numerator, denominator = denominator }
end

-- The value of a number. With integers up to 2^53, it is the result of one division, so it is correctly rounded.
local function scaled(type_, number, parameters)
    local linear = type_.linear
    if type_.scale_by then
        linear = linear[parameters[type_.scale_by]]
        if linear == nil then
            return nil, "missing_parameter"
        end
    end
    if not linear then
        return nil, "no_scale"
    end
    local factor, divisor = 1, linear.divisor
    if linear.times then
        for operator, name in linear.times:gmatch("([*/]?)([%a_][%w_]*)") do
            local value = parameters[name]
            if not value then
                return nil, "missing_parameter"
            end
            local above, below = value.numerator, value.denominator
            if operator == "/" then
                above, below = below, above
            end
            factor, divisor = factor * above, divisor * below
        end
    elseif linear.identity then
        return number
    end
    return (number * linear.factor + linear.addend) * factor / divisor
end

local function is_at_most(high, low, last_high, last_low)
    return high < last_high or (high == last_high and low <= last_low)
end

-- The name for which a raw integer of a number has no value; nil for a number.
local function no_value_of(type_, low, high)
    if type_.float then -- NaN of either sign
        low = type_.width == 32 and low % 2147483648 or low
        high = high % 2147483648
    end
    for _, named in ipairs(type_.no_values) do
        if is_at_most(named[1], named[2], high, low) and is_at_most(high, low, named[3], named[4]) then
            return named[5]
        end
    end
    return nil
end

-- The value of a raw integer with its key: a number in the unit, the name of a member, a list of names of flags; nil and a
-- reason without one. The reason that a spec states for no value has a third result, its name.
local function value_of(type_, raw, key, parameters)
    local no_value = no_value_of(type_, raw.low, raw.high)
    if no_value then
        return nil, "no_value", no_value
    end
    if type_.enum then
        return type_.enum[key]
    end
    if type_.flags then
        local names = {}
        for _, flag in ipairs(type_.flags) do
            if codec.has_flag(raw, flag.bit) then
                names[#names + 1] = flag.name
            end
        end
        return names
    end
    local number = raw.number
    if type_.float then
        number = float_number(type_.width, raw.low, raw.high)
        if number == nil then
            return nil, "not_finite"
        end
    end
    return scaled(type_, number, parameters)
end

local REPLACEMENT = "\239\191\189"

-- How many bytes after the first one belong to a character of UTF-8, and the least and the most of the second one.
local function following(lead)
    if lead < 0x80 then
        return 0
    elseif lead >= 0xC2 and lead <= 0xDF then
        return 1, 0x80, 0xBF
    elseif lead >= 0xE0 and lead <= 0xEF then
        return 2, lead == 0xE0 and 0xA0 or 0x80, lead == 0xED and 0x9F or 0xBF
    elseif lead >= 0xF0 and lead <= 0xF4 then
        return 3, lead == 0xF0 and 0x90 or 0x80, lead == 0xF4 and 0x8F or 0xBF
    end
    return nil
end

-- The text of some bytes; U+FFFD in place of those that are no character.
local function text_of(bytes, last, is_ascii)
    local parts, position = {}, 1
    while position <= last do
        local lead = bytes[position]
        local count, low, high = following(lead)
        if is_ascii and lead >= 0x80 then
            count = nil
        end
        local after = position + 1
        while count and count > 0 and after <= last and bytes[after] >= low and bytes[after] <= high do
            count, low, high, after = count - 1, 0x80, 0xBF, after + 1
        end
        if count == 0 then
            for index = position, after - 1 do
                parts[#parts + 1] = string.char(bytes[index])
            end
        else
            parts[#parts + 1] = REPLACEMENT
        end
        position = after
    end
    return table.concat(parts)
end

-- The value of all elements of a field: a text, or a number of decimal digits; nil and a reason without one.
local function joined_value(type_, raws)
    if type_.digits then
        local number = 0
        for _, digit in ipairs(raws) do
            if digit > 9 then
                return nil, "out_of_range"
            end
            number = number * 10 + digit
        end
        return number
    end
    local last = #raws
    for position, byte in ipairs(raws) do
        if byte == 0 then
            last = position - 1
            break
        end
    end
    while last > 0 and raws[last] == type_.text[2] do
        last = last - 1
    end
    return text_of(raws, last, type_.text[1] == "ascii")
end


-- The node of an id without the bits of keys and fields; false for an id that is not of the rule, nil for a fixed id.
local function node_of_rule(rule, frame)
    if rule.extended ~= frame.extended or rule.remote ~= frame.remote then
        return false
    end
    for number = 1, #rule.offsets do
        local rest = frame[0] - rule.base - rule.offsets[number]
        if #rule.filled > 0 then
            rest = rest - read(frame, rule.filled)
        end
        if not rule.last then
            if rest == 0 then
                return nil
            end
        elseif rest % rule.step == 0 then
            local node = floor(rest / rule.step)
            if node >= rule.first and node <= rule.last then
                return node
            end
        end
    end
    return false
end

-- The node of a frame of a message: that in its id, or else in its data; nil without one.
local function node_of(message, frame, in_id)
    if message.node then
        return (read(frame, message.node))
    end
    return in_id
end

-- The message of a frame of one direction ("requests" or "replies") and its node; nil and the reason without one.
function codec.identify(edition, direction, frame)
    for _, route in ipairs(edition[direction]) do
        local node = node_of_rule(route, frame)
        if node ~= false then
            local step = route.plan
            while type(step) == "table" and step.on do
                local subject = frame.length
                if step.on ~= "length" then
                    subject = read_key(frame, step.on)
                end
                step = step.cases[subject] or step.otherwise
            end
            if type(step) == "string" then
                return nil, step
            end
            return step, node_of(step, frame, node)
        end
    end
    for _, route in ipairs(edition[direction]) do
        if #route.offsets == 0 and route.extended == frame.extended and route.remote == frame.remote then
            return nil, "missing_parameter"
        end
    end
    return nil, "unknown_id"
end

-- The nodes that the id of a frame can mean, and whether requests and replies have the id. A node that is not in the id
-- is `false`.
function codec.nodes(edition, frame)
    local nodes, is_request, is_reply = {}, false, false
    for _, message in ipairs(edition.messages) do
        local node = node_of_rule(message, frame)
        if node ~= false then
            nodes[#nodes + 1] = node or false
            is_request = is_request or message.direction == "request"
            is_reply = is_reply or message.direction == "reply"
        end
    end
    return nodes, is_request, is_reply
end

-- Whether a frame has the id, the length and the keys of a message, and its node.
function codec.is_message(message, frame)
    local node = node_of_rule(message, frame)
    if node == false or (frame.length ~= message.length and not frame.remote) then
        return false
    end
    for _, key in ipairs(message.keys) do
        if not key.values[read_key(frame, key.segments)] then
            return false
        end
    end
    return true, node_of(message, frame, node)
end

local function is_present(field, choice)
    return not field.only or (choice ~= nil and field.only[choice])
end

-- Whether a frame has the constants of a message, under the value of the parameter on which its fields depend.
function codec.has_constants(message, frame, choice)
    for _, field in ipairs(message.layout.constants) do
        if is_present(field, choice) then
            for _, element in ipairs(field.elements) do
                if read_key(frame, element) ~= field.fixed then
                    return false
                end
            end
        end
    end
    return true
end

local function next_register(checksum, register, byte)
    if checksum.arithmetic == "sum" then
        return (register + byte) % checksum.size
    elseif checksum.arithmetic == "xor" then
        return xor(register, byte)
    elseif checksum.reflected then
        return xor(math.floor(register / 256), checksum.register_of[xor(register % 256, byte)])
    end
    local high = math.floor(register / (checksum.size / 256))
    return xor(register * 256 % checksum.size, checksum.register_of[xor(high, byte)])
end

-- The checksum field of a frame, its raw integer, and the checksum of the frame; nil for a message without one.
function codec.checksum(message, frame)
    local checksum = message.checksum
    if not checksum then
        return nil
    end
    local register = checksum.init
    for _, input in ipairs(checksum.inputs) do
        register = next_register(checksum, register, type(input) == "table" and read(frame, input) or input)
    end
    local computed = xor(floor(register / checksum.divisor), checksum.xor)
    return checksum.field, (read(frame, checksum.field.elements[1])), computed
end

-- The reason for which a frame of a message is rejected because of a constant or its checksum, under the value of the
-- parameter on which its fields depend; nil without one.
function codec.rejects(message, frame, choice)
    if not codec.has_constants(message, frame) then
        return "wrong_constant"
    end
    local field, found, computed = codec.checksum(message, frame)
    if field and found ~= computed then
        return "wrong_checksum"
    end
    if choice ~= nil and not codec.has_constants(message, frame, choice) then
        return "wrong_constant"
    end
    return nil
end

-- Whether the reserved bits of a frame are as the spec demands.
function codec.has_regular_bits(message, frame)
    for _, bits in ipairs(message.reserved) do
        if floor((frame[bits[1]] or 0) / bits[2]) % bits[3] ~= bits[4] then
            return false
        end
    end
    return true
end

local function element_is_in_range(type_, frame, element)
    local unsigned_low, unsigned_high = read(frame, element)
    local low, high, number = raw_integer(type_, unsigned_low, unsigned_high)
    if type_.float then
        number = float_number(type_.width, low, high)
    end
    if type_.enum and not type_.enum[key_of(unsigned_low, unsigned_high)] then
        return false
    elseif type_.limits and not no_value_of(type_, low, high) then
        return number ~= nil and number >= type_.limits[1] and number <= type_.limits[2]
    elseif type_.flags then
        for bit = 0, type_.width - 1 do
            if has_bit(low, high, bit) and not type_.named[bit] then
                return false
            end
        end
    end
    return true
end

-- Whether the fields of a frame of this message have named values, and values in their ranges.
function codec.is_in_range(message, frame)
    for _, field in ipairs(message.layout.limited) do
        for _, element in ipairs(field.elements) do
            if not element_is_in_range(field.type, frame, element) then
                return false
            end
        end
    end
    return true
end

-- What is decoded of a field: one table for each element, or one for all elements that are a text or a number together.
local function add_items(items, field)
    if field.type.text or field.type.digits then
        local item = { field = field, name = field.name, segments = {}, raws = {} }
        for _, element in ipairs(field.elements) do
            for _, segment in ipairs(element) do
                item.segments[#item.segments + 1] = segment
            end
        end
        items[#items + 1] = item
        return
    end
    for number, segments in ipairs(field.elements) do
        local index = field.indices and field.indices[number]
        local name = index and string.format("%s[%d]", field.name, index) or field.name
        items[#items + 1] = { field = field, segments = segments, index = index, name = name }
    end
end

-- What is decoded of a layout under the value of its parameter.
local function decoded_items(layout, choice)
    local key = choice or false
    local items = layout.decoded[key]
    if not items then
        items = {}
        for _, field in ipairs(layout.fields) do
            if not field.hidden and is_present(field, choice) then
                add_items(items, field)
            end
        end
        layout.decoded[key] = items
    end
    return items
end

local function read_joined(item, frame)
    for position, element in ipairs(item.field.elements) do
        item.raws[position] = number_at(item.field.type, frame, element)
    end
    item.value, item.reason = joined_value(item.field.type, item.raws)
end

-- The fields of a frame of a message under some parameters: a list of tables with `field`, `segments`, `index` of an
-- element of an array, its `name`, both halves of the raw integer and its `number`, `value`, and the `reason` without a
-- value, with the name that the spec gives `no_value`, or the `name_of_number` that a number has as well. The tables are filled again for the next frame. nil and the reason if the frame is rejected.
function codec.decode(message, frame, parameters)
    local layout = message.layout
    local choice = layout.parameter and parameters[layout.parameter]
    local is_known = not layout.parameter or (choice ~= nil and layout.values[choice])
    local rejected = codec.rejects(message, frame, is_known and choice or nil)
    if rejected then
        return nil, rejected
    end
    if not is_known then
        return nil, "missing_parameter", layout.parameter
    end
    for _, field in ipairs(layout.parametric) do
        if is_present(field, choice) then
            local required = parameters[field.parameter]
            if not required then
                return nil, "missing_parameter", field.parameter
            end
            for _, element in ipairs(field.elements) do
                if number_at(field.type, frame, element) ~= required.numerator / required.denominator then
                    return nil, "wrong_constant"
                end
            end
        end
    end
    local items = decoded_items(layout, choice)
    for number = 1, #items do
        local item = items[number]
        if item.raws then
            read_joined(item, frame)
        else
            local type_, unsigned_low, unsigned_high = item.field.type, read(frame, item.segments)
            item.low, item.high, item.number = raw_integer(type_, unsigned_low, unsigned_high)
            local key = key_of(unsigned_low, unsigned_high)
            item.value, item.reason, item.no_value = value_of(type_, item, key, parameters)
            item.name_of_number = type_.names[key]
        end
    end
    return items
end

local function is_from(nodes, source, modulus)
    if source == nil or #nodes == 0 then
        return true
    end
    for _, node in ipairs(nodes) do
        if node == source or (modulus and node % modulus == source % modulus) then
            return true
        end
    end
    return false
end

local function is_answer(answer, request_node, request_frame, frame)
    local fits, source = codec.is_message(answer.reply, frame)
    if not fits then
        return false
    end
    local to, modulus = request_node, nil
    if answer.asked then
        to, modulus = read(request_frame, answer.asked.segments), answer.asked.modulus
    end
    local nodes = answer.nodes
    if #nodes == 0 and to ~= nil then
        nodes = { to }
    end
    if not is_from(nodes, source, modulus) then
        return false
    end
    if answer.reported then
        local shared = answer.reported.modulus
        if modulus and modulus < shared then
            shared = modulus
        end
        if not is_from(nodes, (read(frame, answer.reported.segments)), shared) then
            return false
        end
    end
    if answer.echo then
        if request_frame.length ~= frame.length then
            return false
        end
        for index = 1, frame.length do
            if request_frame[index] ~= frame[index] then
                return false
            end
        end
    end
    return true, source
end

-- The reply to a request that a frame is, as the request has it in `answers`, and the node that replies; nil if it is none.
function codec.answer(request, request_node, request_frame, frame)
    for _, answer in ipairs(request.answers) do
        local fits, source = is_answer(answer, request_node, request_frame, frame)
        if fits then
            return answer, source
        end
    end
    return nil
end

return codec
