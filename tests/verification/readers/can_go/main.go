// Decodes frames with can-go: FILE, then lines ID#DATA in hexadecimal on standard input.
package main

import (
	"bufio"
	"encoding/hex"
	"fmt"
	"log"
	"os"
	"strconv"
	"strings"

	"go.einride.tech/can"
	"go.einride.tech/can/pkg/dbc"
	"go.einride.tech/can/pkg/descriptor"
)

func main() {
	text, err := os.ReadFile(os.Args[1])
	if err != nil {
		log.Fatal(err)
	}
	parser := dbc.NewParser(os.Args[1], text)
	if err := parser.Parse(); err != nil {
		log.Fatal(err)
	}
	messages := map[dbc.MessageID]*dbc.MessageDef{}
	floats := map[dbc.MessageID]map[dbc.Identifier]bool{}
	for _, def := range parser.Defs() {
		switch def := def.(type) {
		case *dbc.MessageDef:
			messages[def.MessageID] = def
			floats[def.MessageID] = map[dbc.Identifier]bool{}
		case *dbc.SignalValueTypeDef:
			floats[def.MessageID][def.SignalName] = def.SignalValueType == dbc.SignalValueTypeFloat32
		}
	}
	lines := bufio.NewScanner(os.Stdin)
	for lines.Scan() {
		idText, dataText, _ := strings.Cut(lines.Text(), "#")
		id, err := strconv.ParseUint(idText, 16, 32)
		if err != nil {
			log.Fatal(err)
		}
		bytes, err := hex.DecodeString(dataText)
		if err != nil {
			log.Fatal(err)
		}
		var data can.Data
		copy(data[:], bytes)
		message, ok := messages[dbc.MessageID(id)]
		if !ok {
			log.Fatalf("no message %x", id)
		}
		var selector uint64
		for i := range message.Signals {
			if message.Signals[i].IsMultiplexerSwitch {
				selector = signal(&message.Signals[i], false).UnmarshalUnsigned(data)
			}
		}
		for i := range message.Signals {
			def := &message.Signals[i]
			if !def.IsMultiplexed || def.MultiplexerSwitch == selector {
				one := signal(def, floats[message.MessageID][def.Name])
				value := one.UnmarshalPhysical(data)
				if one.IsFloat {
					value = one.ToPhysical(one.UnmarshalFloat(data))
				}
				fmt.Printf("%s=%v ", one.Name, value)
			}
		}
		fmt.Println()
	}
}

func signal(def *dbc.SignalDef, isFloat bool) *descriptor.Signal {
	return &descriptor.Signal{
		Name:        string(def.Name),
		Start:       uint8(def.StartBit),
		Length:      uint8(def.Size),
		IsBigEndian: def.IsBigEndian,
		IsSigned:    def.IsSigned,
		IsFloat:     isFloat,
		Offset:      def.Offset,
		Scale:       def.Factor,
		Min:         def.Minimum,
		Max:         def.Maximum,
	}
}
