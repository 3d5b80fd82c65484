; THEOREM    11b: the geometric lemma, second part: a distance is no less than its part in any
;            direction.
; ASSUMED    n is a unit vector, z any vector of length Z.
; CONCLUDED  n z <= Z; with -z for z, n z >= -Z.
; SOURCE     own; Cauchy and Schwarz.
; TWIN       n may be longer than a unit vector.
; SOLVERS    z3 cvc5
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const nx Real)       ; direction
(declare-const ny Real)
(declare-const zx Real)       ; any vector
(declare-const zy Real)
(declare-const Z Real)        ; its length
; Assumptions
(assert (= (+ (* nx nx) (* ny ny)) 1))
(assert (and (>= Z 0) (= (* Z Z) (+ (* zx zx) (* zy zy)))))
(assert (>= (* (- (* nx zy) (* ny zx)) (- (* nx zy) (* ny zx))) 0))   ; a square: true anyway, a hint for cvc5

; Conclusion, negated
(assert (not (<= (+ (* nx zx) (* ny zy)) Z)))
(check-sat)
