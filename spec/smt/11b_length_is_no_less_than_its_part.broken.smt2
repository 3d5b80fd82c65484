; BROKEN     Twin of 11b_length_is_no_less_than_its_part.smt2: n may be longer than a unit vector.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const nx Real)       ; direction
(declare-const ny Real)
(declare-const zx Real)       ; any vector
(declare-const zy Real)
(declare-const Z Real)        ; its length
; Assumptions
(assert (= (+ (* nx nx) (* ny ny)) 2))                       ; BROKEN: longer than 1
(assert (and (>= Z 0) (= (* Z Z) (+ (* zx zx) (* zy zy)))))
(assert (>= (* (- (* nx zy) (* ny zx)) (- (* nx zy) (* ny zx))) 0))   ; a square: true anyway, a hint for cvc5

; Conclusion, negated
(assert (not (<= (+ (* nx zx) (* ny zy)) Z)))
(check-sat)
