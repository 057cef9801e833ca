module canwright.test/can_go

go 1.23.0

require go.einride.tech/can v0.17.0
